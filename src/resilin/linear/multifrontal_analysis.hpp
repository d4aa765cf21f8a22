#pragma once

#include <vector>

#include "resilin/linear/merged_pattern.hpp"
#include "resilin/linear/trapezoid.hpp"

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

/// The symbolic part of a multifrontal Cholesky factorisation, on the graph of the nodes.
///
/// Source: Liu 1992 (the method); Ashcraft & Grimes 1989 (relaxed supernodes).
struct MultifrontalAnalysis {
  explicit MultifrontalAnalysis(const MergedPattern& pattern);

  /// Position of a matrix block in the panel of its supernode.
  struct Entry {
    Offset slot;        ///< slot of the merged pattern
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

  /// Front by front the factor fills an array of so many blocks from its begin, and update matrices lie at
  /// its end, where the factor comes last.
  Offset shared_blocks = 0;
  std::vector<Offset> update_begin;  ///< by supernode: its update's place there, in blocks

  /// Subtrees at the same time have two stacks each, by the parity of the depth in the tree: then the updates
  /// of a front's children are always on top of one, and its own goes onto the other.
  std::vector<std::uint8_t> stack_of;  ///< by supernode
  struct StackSizes {
    Offset blocks[2] = {0, 0};
  };
  StackSizes subtree_stacks, top_stacks;  ///< memory of the largest subtree; memory of the top
  std::vector<Offset>
      root_update_begin;  ///< by supernode: where a subtree's root keeps its update, in blocks; else -1
  Offset root_update_blocks = 0;

  /// Subtrees that can be factorised at the same time, as ranges [first, last) of supernodes, and what is
  /// above them.
  std::vector<std::pair<Index, Index>> subtrees;
  std::vector<Index> top;
};

}  // namespace resilin
