#include "resilin/linear/aggregation.hpp"

#include <algorithm>
#include <numeric>

namespace resilin {

LowerPattern::LowerPattern(std::span<const Offset> upper_begin, std::span<const Index> upper_columns)
    : begin(upper_begin.size(), 0), columns(upper_columns.size()) {
  for (const Index column : upper_columns) ++begin[column + 1];
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  std::vector<Offset> next(begin.begin(), begin.end() - 1);
  for (Index i = 0; i + 1 < static_cast<Index>(upper_begin.size()); ++i)
    for (Offset k = upper_begin[i]; k < upper_begin[i + 1]; ++k) columns[next[upper_columns[k]]++] = i;
}

Aggregates aggregate(const FullPattern& pattern, std::span<const std::uint8_t> is_active,
                     std::span<const Index> order) {
  Aggregates groups;
  groups.of_node.assign(static_cast<std::size_t>(pattern.num_nodes()), -1);
  const auto for_neighbours = [&](Index i, const auto& visit) {
    pattern.for_row(i, [&](Index j) {
      if (is_active[j] != 0) visit(j);
    });
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
