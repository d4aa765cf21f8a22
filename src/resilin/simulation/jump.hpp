#pragma once

#include <functional>
#include <optional>

#include "resilin/world/world.hpp"

namespace resilin {

/// An equilibrium at rest.
struct Equilibrium {
  double load = 0;
  VectorX positions{};  ///< [m]
};

/// Bodies that went from one equilibrium to another far away while the loads hardly changed: they snapped
/// through, slipped off or unwound, and lost strain energy on the way; or their reactions changed signs.
struct Jump {
  double energy = 0;        ///< energy lost [J]
  double from = 0, to = 0;  ///< load factors between which
  /// Smaller steps go on without one, on another path than that of the step.
  bool is_avoidable = false;
};

/// By how much the strain energy falls more from one equilibrium to another, or rises less, than the work of
/// all other forces explains, by the mean of those at both ends [J]. For steps that grow shorter it vanishes
/// with their cube, unless there is a jump.
double released_energy(const World& world, const Equilibrium& from, const Equilibrium& to);

/// The equilibrium at a load that a search finds from another one; none where it finds none.
using FindEquilibrium = std::function<std::optional<Equilibrium>(const Equilibrium& from, double load)>;

/// Looks at a load step, and where its energies do not fit the work at parts of it, down to a 32nd.
std::optional<Jump> find_jump(const World& world, const Equilibrium& from, const Equilibrium& to,
                              const FindEquilibrium& find);

}  // namespace resilin
