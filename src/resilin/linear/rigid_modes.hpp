#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "resilin/linear/aggregation.hpp"

namespace resilin {

/// Modes by node: `size` rows of `count` numbers for each.
struct Modes {
  int size = 0;
  int count = 0;
  std::vector<double> values;
  double* of(Index node) { return values.data() + static_cast<Offset>(node) * size * count; }
  const double* of(Index node) const { return values.data() + static_cast<Offset>(node) * size * count; }
};

/// Translations and infinitesimal rotations (3 in 2D, 6 in 3D), zero in the unknowns that are fixed. Without
/// positions the rotations are zero.
Modes rigid_modes(int dim, const VectorX& positions, std::span<const std::uint8_t> is_fixed);

/// Orthonormal modes of every group of nodes, and how the given ones are combined from them.
struct TentativeProlongation {
  Modes fine;                           ///< Q: zero columns where the modes of a group depend on each other
  Modes coarse;                         ///< R, by group: the modes that the next level keeps
  std::vector<std::uint8_t> is_absent;  ///< by coarse unknown: its column of Q is zero
};

TentativeProlongation orthonormalize(const Modes& modes, const Aggregates& groups);

}  // namespace resilin
