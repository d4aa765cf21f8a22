#pragma once

#include <span>
#include <string>
#include <vector>

#include "resilin/core/types.hpp"
#include "resilin/element/element.hpp"
#include "resilin/energy/kernels/element_kernels.hpp"

namespace resilin {

/// The cells of a body as the kernels want them: nodes numbered along a space-filling curve, cells sorted by
/// their nodes, eight to a block; the last block is filled up with copies of its last cell that have no
/// volume.
struct ElementBlocks {
  int dim = 3;
  int num_nodes = 4;           ///< number of nodes of an element
  std::size_t num_points = 1;  ///< number of points of an element
  Index num_cells = 0;
  std::size_t num_blocks = 0;

  std::vector<Index> world_nodes;      ///< by local node, its number in the world
  std::vector<double> rest_positions;  ///< by local node, with the stride of the kernels [m]
  std::vector<Index> cells;            ///< [block][lane]: number of the cell, -1 for a copy
  /// [block][node][lane], local. Linear simplices have the nodes of a cell in the order of their world
  /// numbers, other elements in their own.
  std::vector<Index> nodes;
  /// [1/m] Linear simplices: dN/dX, [block][node - 1][component][lane], where they are held (ElasticTiles);
  /// other elements: dxi/dX by rows, [block][point][dim * dim][lane].
  std::vector<double> gradients;
  std::vector<double> weights;  ///< [block][point][lane], rest volume [m^3] (2D [m^2] on unit thickness)
  std::vector<double> reference_gradients;  ///< but for linear simplices: [point][node][dim], dN/dxi

  bool is_linear_simplex() const { return num_nodes == dim + 1; }
  int num_pairs() const { return num_nodes * (num_nodes + 1) / 2; }
  Index num_local_nodes() const { return static_cast<Index>(world_nodes.size()); }
  std::size_t stride() const { return static_cast<std::size_t>(node_stride(dim)); }

  /// u = x - X by local node, with the stride of the kernels.
  std::vector<double> local_displacements(const VectorX& x) const;
  /// A vector of the world by local node, such as a step.
  std::vector<double> local_values(const VectorX& world_values) const;
};

/// @param cells           world node numbers, element.num_nodes for each cell
/// @param rest_positions  of all nodes of the world [m]
/// @throws InputError     when a cell has no positive volume or a node number is out of range
ElementBlocks make_element_blocks(const ElementInfo& element, const QuadratureRule& rule,
                                  std::span<const Index> cells, const VectorX& rest_positions);

/// A share of the work on rows: the blocks that touch the nodes of a part, which it alone writes.
struct OwnerPart {
  OwnedNodes owned;
  std::vector<Index> blocks;
};

/// Splits the nodes into `count` ranges of about the same number of cells. Each part goes through its blocks
/// in the order of all blocks, so what a node sums does not depend on `count`.
std::vector<OwnerPart> split_by_owner(const ElementBlocks& blocks, int count);

}  // namespace resilin
