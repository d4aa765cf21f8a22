#pragma once

#include <utility>
#include <vector>

#include "resilin/contact/term_sums.hpp"

namespace resilin {

/// Forces that only press, with the same sum: those of terms that take back what others count twice
/// (ContactTerm) are taken from the parts of the surface that count it.
///
/// Over a valley a point is pressed by the triangles on both sides, A and B, less by their edge, E: of that a
/// side bears the more the nearer its own force is to E. So a side fades away as the point leaves it, and the
/// forces follow the point without a jump.
/// @param forces  the terms of each point one after the other
std::vector<PartForce> pressing_forces(std::vector<PartForce> forces);

/// One of them, and how its force follows from those that are given.
struct PressingForce {
  std::size_t part;  ///< its number among those
  double force;      ///< [N]
  std::vector<std::pair<std::size_t, double>> slopes;
};
/// The same, in their order.
std::vector<PressingForce> pressing_slopes(const std::vector<PartForce>& forces);

}  // namespace resilin
