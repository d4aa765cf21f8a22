#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "resilin/core/types.hpp"

namespace resilin {

/// Both triangles of a symmetric pattern, by rows, columns ascending.
struct FullPattern {
  std::vector<Offset> begin;  ///< num_nodes + 1
  std::vector<Index>
      blocks;  ///< -1: the diagonal; k: entry k of the strictly upper part; -2 - k: its transpose
  std::vector<Index> columns;

  FullPattern() = default;
  FullPattern(const std::vector<Offset>& upper_begin, const std::vector<Index>& upper_columns);
  Index num_nodes() const { return static_cast<Index>(begin.size()) - 1; }
};

/// Groups of neighbouring nodes: the nodes of the next coarser level.
struct Aggregates {
  Index count = 0;
  std::vector<Index> of_node;  ///< -1 for nodes that are left out
};

/// A node whose neighbours are all free founds a group with them; what is left joins the neighbouring group
/// with most couplings. Nodes that are not active stay out. Source: Vanek, Mandel, Brezina 1996,
/// algorithm 5.1.
/// @param order  in which nodes are looked at: neighbours near each other, or groups leave gaps
Aggregates aggregate(const FullPattern& pattern, std::span<const std::uint8_t> is_active,
                     std::span<const Index> order);

}  // namespace resilin
