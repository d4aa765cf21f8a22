#pragma once

#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "resilin/core/types.hpp"

namespace resilin {

/// Pattern of the dim x dim blocks of a symmetric matrix: the upper triangle, by block rows.
///
/// Row i holds columns columns[row_begin[i]] .. columns[row_begin[i+1]-1], ascending, the diagonal i first.
/// The position of a block in `columns` is its slot; values of slot s start at s * dim * dim, row-major.
struct BlockPattern {
  std::vector<Offset> row_begin;  ///< num_nodes + 1
  std::vector<Index> columns;

  Index num_nodes() const { return static_cast<Index>(row_begin.size()) - 1; }
  Offset num_slots() const { return static_cast<Offset>(columns.size()); }

  /// Slot of block (i, j), i <= j. The pair must be in the pattern.
  Offset slot(Index i, Index j) const;
  /// The same, or -1 when the pair is not in the pattern.
  Offset find_slot(Index i, Index j) const;

  /// Derived from the two arrays above by `complete`, which the builder calls. A product runs over fixed
  /// chunks of rows at the same time. A chunk adds the transposed blocks whose column lies beyond its last
  /// row to places of its own, which are summed afterwards in the order of the chunks.
  struct ProductPlan {
    std::vector<Index> chunk_begin;    ///< first row of every chunk, then num_nodes
    std::vector<Index> targets;        ///< by slot: its column, or num_nodes + a place of the chunk
    std::vector<Index> chunk_places;   ///< first place of every chunk, then their number
    std::vector<Index> gather_begin;   ///< num_nodes + 1
    std::vector<Index> gather_places;  ///< by node: the places to be added to it

    Index num_chunks() const { return static_cast<Index>(chunk_begin.size()) - 1; }
  };
  ProductPlan product_plan;

  /// `slots_per_chunk` sets the size of the chunks of a product.
  void complete(Offset slots_per_chunk = 4096);
};

/// Collects which nodes are coupled.
class BlockPatternBuilder {
 public:
  explicit BlockPatternBuilder(Index num_nodes) : num_nodes_(num_nodes) {}

  /// All nodes of every cell are coupled with each other; `nodes` holds `nodes_per_cell` for each cell.
  void add_cells(std::vector<Index> nodes, int nodes_per_cell);
  void add_pair(Index i, Index j) { pairs_.emplace_back(i, j); }
  /// All of these nodes are coupled with each other.
  void add_clique(std::span<const Index> nodes);
  Index num_nodes() const { return num_nodes_; }

  /// Throws InputError where there are more couplings than slots can be numbered.
  BlockPattern build() const;

 private:
  Index num_nodes_;
  std::vector<std::pair<std::vector<Index>, int>> cells_;
  std::vector<std::pair<Index, Index>> pairs_;
};

}  // namespace resilin
