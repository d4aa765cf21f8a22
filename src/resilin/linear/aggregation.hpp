#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "resilin/core/types.hpp"

namespace resilin {

/// The strictly lower triangle of a symmetric pattern by rows, columns ascending: transposes of the upper
/// entries, in their order.
struct LowerPattern {
  std::vector<Offset> begin;   ///< num_nodes + 1
  std::vector<Index> columns;  ///< those of the upper entries' rows

  LowerPattern() = default;
  LowerPattern(std::span<const Offset> upper_begin, std::span<const Index> upper_columns);
};

/// Both triangles by rows, columns ascending: a view of their arrays.
struct FullPattern {
  std::span<const Offset> upper_begin;
  std::span<const Index> upper_columns;
  const LowerPattern& lower;

  Index num_nodes() const { return static_cast<Index>(upper_begin.size()) - 1; }
  std::size_t num_entries() const { return 2 * upper_columns.size() + static_cast<std::size_t>(num_nodes()); }
  /// Calls visit(column) for the entries of a row.
  template <class Visit>
  void for_row(Index row, const Visit& visit) const {
    for (Offset k = lower.begin[row]; k < lower.begin[row + 1]; ++k) visit(lower.columns[k]);
    visit(row);
    for (Offset k = upper_begin[row]; k < upper_begin[row + 1]; ++k) visit(upper_columns[k]);
  }
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
