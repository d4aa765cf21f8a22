#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "resilin/core/types.hpp"
#include "resilin/element/element.hpp"

namespace resilin {

/// Deformation gradients at nodes: of the cells around each, the mean over their rest volume.
///
///   F_a = sum_cells int F dV / sum_cells V = sum_b x_b g_ab^T
class NodeGradients {
 public:
  /// @param cells           nodes, element.num_nodes for each cell
  /// @param rest_positions  dim numbers per node [m]
  /// @param nodes           where F is wanted; each belongs to a cell, none is there twice
  NodeGradients(const ElementInfo& element, std::span<const Index> cells, const VectorX& rest_positions,
                std::span<const Index> nodes);

  /// @param x  dim numbers per node [m]
  /// @param F  one for each of the nodes; in 2D with zeros in the third row and column
  void evaluate(const VectorX& x, std::span<Matrix<3>> F) const;

  /// Calls `visit(b, g_ab)` for the nodes b that F at the a-th of the nodes depends on.
  template <class Visit>
  void for_each_neighbor(std::size_t a, const Visit& visit) const {
    for (std::size_t i = first_[a]; i < first_[a + 1]; ++i) visit(neighbors_[i], gradients_[i]);
  }

 private:
  int dim_;
  std::vector<std::size_t> first_;  ///< first neighbour of each node
  std::vector<Index> neighbors_;
  std::vector<Vector3> gradients_;  ///< g_ab [1/m]
};

}  // namespace resilin
