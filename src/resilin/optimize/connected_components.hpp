#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "resilin/core/process_group.hpp"
#include "resilin/linear/block_matrix.hpp"

namespace resilin {

/// Degrees of freedom of a norm.
enum class Unknowns { all, free, fixed };

/// The connected components of the nodes in the pattern of the Hessian: bodies, or pieces of them, that do
/// not touch. Each component is in balance or not whatever becomes of the others.
class ConnectedComponents {
 public:
  /// The components of the pattern, over all processes of a scene. Nodes that are coupled with
  /// none belong to the first piece.
  explicit ConnectedComponents(const BlockPattern& pattern, ProcessGroup share = {});

  Index count() const { return count_; }
  Index num_nodes() const { return static_cast<Index>(part_of_.size()); }
  Index of_node(Index node) const { return part_of_[static_cast<std::size_t>(node)]; }
  /// The scene whose nodes these are: vectors and sums over them are those of all its processes.
  const ProcessGroup& share() const { return share_; }

  /// The components when the extra blocks of a matrix couple some of them.
  ConnectedComponents joined_by(const BlockMatrix& hessian) const;

  /// The Euclidean norm of `values` over the unknowns of each component.
  /// @param is_fixed  per unknown; its size is that of `values`
  VectorX norms(const VectorX& values, std::span<const std::uint8_t> is_fixed, Unknowns which) const;
  /// The largest |value| of each component.
  VectorX largest(const VectorX& values) const;

 private:
  /// The sum of the squares of `values` times the unit of each component.
  VectorX squares(const VectorX& values, const VectorX& units, std::span<const std::uint8_t> is_fixed,
                  Unknowns which) const;

  /// The same over the nodes that this process owns.
  VectorX own_squares(const VectorX& values, const VectorX& units, std::span<const std::uint8_t> is_fixed,
                      Unknowns which) const;
  /// Pieces of one process that hang together through others become one.
  void join_across(const std::vector<bool>& is_coupled);

  ProcessGroup share_;
  std::vector<Index> part_of_;
  Index count_ = 1;
};

/// Multiplies the rows and columns of each component by a positive number, which changes no solution of a
/// system whose right-hand side is multiplied likewise: only in what measure an iterative solver sees the
/// components.
void scale_components(const ConnectedComponents& parts, const VectorX& weights, BlockMatrix& matrix);
void scale_components(const ConnectedComponents& parts, const VectorX& weights, VectorX& right_side);

}  // namespace resilin
