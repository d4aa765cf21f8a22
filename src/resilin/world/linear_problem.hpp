#pragma once

#include <optional>
#include <string>

#include "resilin/world/world.hpp"

namespace resilin {

/// Whether the static problem of a world is linear: linear elasticity everywhere, dead loads and springs, no
/// follower pressure. Its energy is quadratic: one linear solve gives the answer.
bool is_linear(const World& world);

/// The first element inversion of a linear-elastic solution.
struct Inversion {
  double load = 0;  ///< the load factor at which the volume ratio reaches zero
  int body = 0;
  Index cell = 0;  ///< cell of the body
};

/// On the straight path from the rest shape through `positions`, the equilibrium at load factor `load` > 0,
/// and beyond: J(t) = det(I + t/load grad u) is zero first where grad u has its most negative real eigenvalue
/// e, at t = -load/e. At the quadrature points; none when nothing inverts at any load, or when supports turn
/// or loads follow time, for then the path is not straight.
std::optional<Inversion> first_inversion(const World& world, const VectorX& positions, double load);

/// "cell 7 of "beam" is inverted beyond load factor 0.61".
std::string describe(const World& world, const Inversion& inversion);

}  // namespace resilin
