#include "resilin/linear/permuted_pattern.hpp"

#include <algorithm>

#include "resilin/linear/ordering.hpp"

namespace resilin {

PermutedPattern::PermutedPattern(const MergedPattern& pattern, const NodeGraph& graph,
                                 std::vector<Index> order)
    : node_at(std::move(order)), row_begin(1, 0) {
  const std::vector<Index> position = inverse_of(node_at);
  columns.reserve(graph.neighbours.size() / 2);
  for (const Index node : node_at) {
    for (Index k = graph.begin[node]; k < graph.begin[node + 1]; ++k)
      if (position[graph.neighbours[k]] > position[node]) columns.push_back(position[graph.neighbours[k]]);
    std::sort(columns.begin() + row_begin.back(), columns.end());
    row_begin.push_back(static_cast<Offset>(columns.size()));
  }
  block_of_slot.reserve(pattern.columns.size());
  for (Index node = 0; node < num_nodes(); ++node)
    for (Offset s = pattern.row_begin[node]; s < pattern.row_begin[node + 1]; ++s) {
      const Index i = position[node], j = position[pattern.columns[s]];
      block_of_slot.push_back(i <= j ? find(i, j) : ~find(j, i));
    }
}

Index PermutedPattern::find(Index i, Index j) const {
  if (i == j) return i;
  const auto end = columns.begin() + row_begin[i + 1];
  const auto found = std::lower_bound(columns.begin() + row_begin[i], end, j);
  return found != end && *found == j ? num_nodes() + static_cast<Index>(found - columns.begin()) : -1;
}

}  // namespace resilin
