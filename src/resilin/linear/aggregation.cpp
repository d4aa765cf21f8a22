#include "resilin/linear/aggregation.hpp"

#include <algorithm>

namespace resilin {

FullPattern::FullPattern(const std::vector<Offset>& upper_begin, const std::vector<Index>& upper_columns) {
  const auto n = static_cast<Index>(upper_begin.size()) - 1;
  begin.assign(upper_begin.size(), 0);
  for (Index i = 0; i < n; ++i) {
    begin[i + 1] += 1 + upper_begin[i + 1] - upper_begin[i];
    for (Offset k = upper_begin[i]; k < upper_begin[i + 1]; ++k) ++begin[upper_columns[k] + 1];
  }
  for (Index i = 0; i < n; ++i) begin[i + 1] += begin[i];
  blocks.resize(static_cast<std::size_t>(begin[n]));
  columns.resize(blocks.size());
  std::vector<Offset> next(begin.begin(), begin.end() - 1);
  const auto put = [&](Index row, Index column, Index block) {
    columns[next[row]] = column;
    blocks[next[row]++] = block;
  };
  for (Index i = 0; i < n; ++i) {  // what stands below row i's diagonal came with the rows before
    put(i, i, -1);
    for (Offset k = upper_begin[i]; k < upper_begin[i + 1]; ++k) {
      put(i, upper_columns[k], static_cast<Index>(k));
      put(upper_columns[k], i, static_cast<Index>(-2 - k));
    }
  }
}

Aggregates aggregate(const FullPattern& pattern, std::span<const std::uint8_t> is_active,
                     std::span<const Index> order) {
  Aggregates groups;
  groups.of_node.assign(static_cast<std::size_t>(pattern.num_nodes()), -1);
  const auto for_neighbours = [&](Index i, const auto& visit) {
    for (Offset e = pattern.begin[i]; e < pattern.begin[i + 1]; ++e)
      if (is_active[pattern.columns[e]] != 0) visit(pattern.columns[e]);
  };
  for (const Index i : order) {
    if (is_active[i] == 0) continue;
    bool is_free = true;
    for_neighbours(i, [&](Index j) { is_free = is_free && groups.of_node[j] < 0; });
    if (!is_free) continue;
    for_neighbours(i, [&](Index j) { groups.of_node[j] = groups.count; });
    ++groups.count;
  }
  const std::vector<Index> founded = groups.of_node;
  std::vector<int> couplings(static_cast<std::size_t>(groups.count), 0);
  for (const Index i : order) {
    if (is_active[i] == 0 || founded[i] >= 0) continue;
    Index best = -1;
    for_neighbours(i, [&](Index j) {
      const Index group = founded[j];
      if (group < 0) return;
      ++couplings[group];
      if (best < 0 || couplings[group] > couplings[best]) best = group;
    });
    for_neighbours(i, [&](Index j) {
      if (founded[j] >= 0) couplings[founded[j]] = 0;
    });
    groups.of_node[i] = best;  // there is one: else the node would have founded a group
  }
  return groups;
}

}  // namespace resilin
