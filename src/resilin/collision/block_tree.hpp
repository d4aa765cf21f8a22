#pragma once

#include <span>
#include <vector>

#include "resilin/collision/kernels/box_kernels.hpp"
#include "resilin/core/types.hpp"

namespace resilin {

/// A tree of boxes around the parts of a surface, eight to a block and eight blocks to a block above, in the
/// order of a curve through space (Morton 1966), each body by itself. The order is kept while the boxes
/// follow the moving vertices. Sources: Lauterbach et al. 2009, "Fast BVH Construction on GPUs" (order along
/// the curve); Wald, Benthin & Boulos 2008, "Getting Rid of Packets" (many boxes in a node).
class BlockTree {
 public:
  BlockTree() = default;

  /// @param vertices           of the parts, `vertices_per_part` each
  /// @param bodies             of all vertices
  /// @param points             where the vertices stand
  BlockTree(std::span<const Index> vertices, int vertices_per_part, std::span<const Index> bodies,
            std::span<const MovingPoint> points);

  /// Boxes around those of the vertices.
  void refit(const BoxKernels& kernels, std::span<const BoxRow> vertex_rows);

  bool empty() const { return parts_.empty(); }
  std::size_t num_leaf_blocks() const { return parts_.size() / boxes_per_block; }
  BlockTreeView view() const;

  /// The part in a place; there are `boxes_per_block` places in a block.
  Index part(std::size_t place) const { return parts_[place]; }

 private:
  void set_order(std::span<const Index> vertices, std::span<const Index> bodies,
                 std::span<const MovingPoint> points);
  void set_vertices(std::span<const Index> vertices);
  void set_levels(std::vector<Index> bodies_of_blocks);

  int vertices_per_part_ = 1;
  std::vector<Index> parts_;     ///< parts of each place; -1 where a body ends within a block
  std::vector<Index> vertices_;  ///< [block][vertex of the part][place in the block]; -1 likewise
  std::vector<std::size_t> level_begin_;
  std::vector<BoxBlock> blocks_;
  std::vector<Index> child_bodies_;
  std::vector<BoxRow> around_;  ///< the boxes around all blocks
};

}  // namespace resilin
