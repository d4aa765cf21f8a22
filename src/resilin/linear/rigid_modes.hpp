#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "resilin/linear/aggregation.hpp"

namespace resilin {

/// Translations and infinitesimal rotations (3 in 2D, 6 in 3D), zero in the unknowns that are fixed; made
/// node by node when they are asked for. Without positions the rotations are zero.
class RigidModes {
 public:
  int size;   ///< rows of a node: dim
  int count;  ///< count of modes

  /// @param positions, is_fixed  dim for each node; must live as long as this
  /// @param node_at              the node that is meant by each number
  RigidModes(int dim, const VectorX& positions, std::span<const std::uint8_t> is_fixed,
             std::span<const Index> node_at);
  Index num_nodes() const { return static_cast<Index>(node_at_.size()); }
  /// Writes `size` rows of `count` numbers.
  void write(Index number, double* rows) const;

 private:
  Vector3 position(Index node) const;

  const VectorX& positions_;
  std::span<const std::uint8_t> is_fixed_;
  std::span<const Index> node_at_;
  Vector3 center_ = Vector3::Zero();
  double radius_ = 0;
};

/// The modes of a coarse level by node: `count` rows of `count` numbers for each.
struct CoarseModes {
  int size = 0;
  int count = 0;
  std::vector<double> values;

  Index num_nodes() const { return static_cast<Index>(values.size()) / (size * count); }
  double* of(Index node) { return values.data() + static_cast<Offset>(node) * size * count; }
  const double* of(Index node) const { return values.data() + static_cast<Offset>(node) * size * count; }
  void write(Index node, double* rows) const;
};

/// Orthonormal modes of every group of nodes, and how the given ones are combined from them.
struct TentativeProlongation {
  std::vector<float> fine;              ///< Q by node, as the modes: zero columns where those of a group
                                        ///< depend on each other
  CoarseModes coarse;                   ///< R, by group: the modes that the next level keeps
  std::vector<std::uint8_t> is_absent;  ///< by coarse unknown: its column of Q is zero
};

/// Tentative prolongation of smoothed aggregation: Q of the modes on each aggregate.
TentativeProlongation orthonormalize(const RigidModes& modes, const Aggregates& groups);
TentativeProlongation orthonormalize(const CoarseModes& modes, const Aggregates& groups);

}  // namespace resilin
