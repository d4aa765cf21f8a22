#pragma once

#include <vector>

#include "resilin/linear/merged_pattern.hpp"

namespace resilin {

/// Consecutive columns of the factor that share their rows below: one dense front.
struct Supernode {
  Index first = 0;  ///< position of its first column (a node)
  Index num_columns = 0;
  Index parent = -1;
  Offset rows_begin = 0, rows_end = 0;  ///< its rows below, in MultifrontalAnalysis::rows
  Offset factor_begin = 0;              ///< its columns in the factor, in blocks

  Index num_rows() const { return static_cast<Index>(rows_end - rows_begin); }
  Index front_size() const { return num_columns + num_rows(); }
};

/// The lower triangle of an update matrix, in blocks of columns that begin at their diagonal: column-major
/// trapezoids one after the other, as wide as this many nodes.
struct UpdateLayout {
  static constexpr Index nodes_per_block = 48;

  int order;        ///< of the matrix
  int block_width;  ///< columns of a block

  int first_of_block(int column) const { return column / block_width * block_width; }
  int stride(int column) const { return order - first_of_block(column); }
  /// Where row 0 of a column would be: the rows from its block on are there.
  Offset column_begin(int column) const {
    const Offset first = first_of_block(column), num_blocks = first / block_width;
    const Offset blocks_before =
        first * order - static_cast<Offset>(block_width) * block_width * (num_blocks * (num_blocks - 1) / 2);
    return blocks_before + (column - first) * (order - first) - first;
  }
  Offset size() const {
    const int first_of_last = first_of_block(order), rest = order - first_of_last;
    return column_begin(first_of_last) + first_of_last + static_cast<Offset>(rest) * rest;
  }
};

/// The symbolic part of a multifrontal Cholesky factorisation, on the graph of the nodes.
///
/// Source: Liu 1992 (the method); Ashcraft & Grimes 1989 (relaxed supernodes).
struct MultifrontalAnalysis {
  explicit MultifrontalAnalysis(const MergedPattern& pattern);

  /// Where a block of the matrix goes in the panel of its supernode.
  struct Entry {
    Offset slot;        ///< of the merged pattern
    Index row, column;  ///< blocks, within the front
    bool is_transposed;
  };

  std::vector<Index> node_at;         ///< by position
  std::vector<Supernode> supernodes;  ///< children before parents, every subtree consecutive
  std::vector<Index> rows;            ///< positions, ascending for each supernode
  std::vector<Index> places;          ///< by row: its place in the parent's front
  std::vector<Index> child_begin, children;
  std::vector<Offset> entry_begin;  ///< by supernode
  std::vector<Entry> entries;
  Offset factor_blocks = 0;  ///< blocks stored for the factor

  /// Update matrices live on two stacks, by the parity of their depth in the tree: then those of a front's
  /// children are always on top of one, and its own goes onto the other.
  std::vector<std::uint8_t> stack_of;  ///< by supernode
  struct StackSizes {
    Offset blocks[2] = {0, 0};
  };
  StackSizes all_stacks;                  ///< what one thread needs for the whole tree
  StackSizes subtree_stacks, top_stacks;  ///< what any one subtree needs; what the top needs
  std::vector<Offset>
      root_update_begin;  ///< by supernode: where a subtree's root keeps its update, in blocks; else -1
  Offset root_update_blocks = 0;

  /// Subtrees that can be factorised at the same time, as ranges [first, last) of supernodes, and what is
  /// above them.
  std::vector<std::pair<Index, Index>> subtrees;
  std::vector<Index> top;
};

}  // namespace resilin
