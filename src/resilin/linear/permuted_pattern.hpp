#pragma once

#include <vector>

#include "resilin/linear/merged_pattern.hpp"

namespace resilin {

/// The pattern of a matrix with its nodes renumbered. Blocks are counted as preconditioners store them: block
/// i is the diagonal of position i, block num_nodes + k stands above the diagonal in column columns[k].
struct PermutedPattern {
  std::vector<Index> node_at;        ///< by position
  std::vector<Offset> row_begin;     ///< row begin of the strictly upper part, by position
  std::vector<Index> columns;        ///< positions, ascending in a row
  std::vector<Index> block_of_slot;  ///< by slot of the merged pattern; ~block when the transpose is stored

  PermutedPattern() = default;
  PermutedPattern(const MergedPattern& pattern, const NodeGraph& graph, std::vector<Index> order);

  Index num_nodes() const { return static_cast<Index>(node_at.size()); }
  Offset num_blocks() const { return static_cast<Offset>(node_at.size() + columns.size()); }
  /// Block of the pair i <= j, or -1.
  Index find(Index i, Index j) const;
};

}  // namespace resilin
