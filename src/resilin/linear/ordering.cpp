#include "resilin/linear/ordering.hpp"

#include <algorithm>
#include <numeric>
#ifdef RESILIN_HAS_METIS
#include <metis.h>

#include <new>

#include "resilin/core/memory.hpp"
#else
#include <Eigen/OrderingMethods>
#include <Eigen/SparseCore>
#endif

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

#ifdef RESILIN_HAS_METIS

std::vector<Index> fill_reducing_order(const NodeGraph& graph) {
  std::vector<idx_t> begin(graph.begin.begin(), graph.begin.end());
  std::vector<idx_t> neighbours(graph.neighbours.begin(), graph.neighbours.end());
  const auto n = static_cast<std::size_t>(graph.num_nodes());
  std::vector<idx_t> node_at(n), position(n);
  std::iota(node_at.begin(), node_at.end(), 0);
  if (neighbours.empty())
    return {node_at.begin(), node_at.end()};  // METIS has no answer to a graph without edges
  idx_t options[METIS_NOPTIONS];
  METIS_SetDefaultOptions(options);
  options[METIS_OPTION_NUMBERING] = 0;
  options[METIS_OPTION_SEED] = 1;
  auto num_nodes = static_cast<idx_t>(n);
  // METIS complains of memory on its own and by signals: it is asked for before. Its graphs, from fine to
  // coarse and cut in two, take some five times the first one; the workspace about as much.
  constexpr std::size_t small = std::size_t{1} << 20, graphs = 6;
  if (!can_allocate(small + graphs * sizeof(idx_t) * (neighbours.size() * 2 + n * 5))) throw std::bad_alloc();
  const int status = METIS_NodeND(&num_nodes, begin.data(), neighbours.data(), nullptr, options,
                                  node_at.data(), position.data());
  if (status == METIS_ERROR_MEMORY) throw std::bad_alloc();
  return {node_at.begin(), node_at.end()};
}

#else

std::vector<Index> fill_reducing_order(const NodeGraph& graph) {
  using Pattern = Eigen::SparseMatrix<double>;
  const std::vector<double> ones(graph.neighbours.size(), 1.0);
  const Eigen::Map<const Pattern> pattern(graph.num_nodes(), graph.num_nodes(),
                                          static_cast<Offset>(graph.neighbours.size()), graph.begin.data(),
                                          graph.neighbours.data(), ones.data());
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> order;
  Eigen::AMDOrdering<int>()(Pattern(pattern), order);
  return {order.indices().data(), order.indices().data() + order.size()};
}

#endif

}  // namespace resilin
