#include "resilin/linear/ordering.hpp"

#include <algorithm>

namespace resilin {
namespace {

/// Breadth-first levels from `start` over nodes that carry no `mark`; appends them to `order`. Returns the
/// number of levels.
int append_levels(const NodeGraph& graph, Index start, std::vector<int>& marks, int mark,
                  std::vector<Index>& order) {
  const auto degree = [&](Index i) { return graph.begin[i + 1] - graph.begin[i]; };
  int levels = 0;
  std::size_t level_begin = order.size();
  order.push_back(start);
  marks[start] = mark;
  while (level_begin < order.size()) {
    const std::size_t level_end = order.size();
    for (std::size_t k = level_begin; k < level_end; ++k) {
      const std::size_t first = order.size();
      for (Index e = graph.begin[order[k]]; e < graph.begin[order[k] + 1]; ++e) {
        const Index neighbour = graph.neighbours[e];
        if (marks[neighbour] == mark) continue;
        marks[neighbour] = mark;
        order.push_back(neighbour);
      }
      std::stable_sort(order.begin() + static_cast<Offset>(first), order.end(),
                       [&](Index a, Index b) { return degree(a) < degree(b); });
    }
    level_begin = level_end;
    ++levels;
  }
  return levels;
}

/// A node at the far end of the component of `start`: restarts from the last level while the depth grows.
Index far_end(const NodeGraph& graph, Index start, std::vector<int>& marks, int& mark) {
  std::vector<Index> order;
  int depth = 0;
  for (;;) {
    order.clear();
    const int new_depth = append_levels(graph, start, marks, ++mark, order);
    if (new_depth <= depth) return start;
    depth = new_depth;
    start = order.back();
  }
}

}  // namespace

std::vector<Index> reverse_cuthill_mckee(const NodeGraph& graph) {
  const auto n = static_cast<std::size_t>(graph.num_nodes());
  std::vector<Index> order;
  order.reserve(n);
  std::vector<int> trial_marks(n, 0), is_placed(n, 0);
  int mark = 0;
  for (Index i = 0; i < graph.num_nodes(); ++i) {
    if (is_placed[i] != 0) continue;
    append_levels(graph, far_end(graph, i, trial_marks, mark), is_placed, 1, order);
  }
  std::reverse(order.begin(), order.end());
  return order;
}

}  // namespace resilin
