#include "resilin/linear/ordering.hpp"

#include <algorithm>
#include <numeric>
#ifdef RESILIN_HAS_METIS
#include <metis.h>

#include <mutex>
#include <new>

#include "resilin/core/memory.hpp"
#else
#include <Eigen/OrderingMethods>
#include <Eigen/SparseCore>
#endif

namespace resilin {
namespace {

/// A node at the far end of the component of `start`: restarts from the last layer while the depth grows.
Index far_end(const NodeGraph& graph, Index start, std::vector<int>& marks, int& mark) {
  std::vector<Index> order, ends;
  std::size_t depth = 0;
  for (;;) {
    order.assign(1, start);
    marks[start] = ++mark;
    ends.clear();
    append_layers(graph, 0, marks, mark, order, ends);
    if (ends.size() <= depth) return start;
    depth = ends.size();
    start = order.back();
  }
}

}  // namespace

void append_layers(const NodeGraph& graph, std::size_t begin, std::vector<int>& marks, int mark,
                   std::vector<Index>& order, std::vector<Index>& ends) {
  const auto degree = [&](Index i) { return graph.begin[i + 1] - graph.begin[i]; };
  while (begin < order.size()) {
    const std::size_t end = order.size();
    for (std::size_t k = begin; k < end; ++k) {
      const auto first = static_cast<Offset>(order.size());
      for (Index e = graph.begin[order[k]]; e < graph.begin[order[k] + 1]; ++e) {
        const Index neighbour = graph.neighbours[e];
        if (marks[neighbour] == mark) continue;
        marks[neighbour] = mark;
        order.push_back(neighbour);
      }
      std::stable_sort(order.begin() + first, order.end(),
                       [&](Index a, Index b) { return degree(a) < degree(b); });
    }
    begin = end;
    ends.push_back(static_cast<Index>(end));
  }
}

LayeredOrder reverse_cuthill_mckee(const NodeGraph& graph) {
  const auto n = static_cast<std::size_t>(graph.num_nodes());
  LayeredOrder result;
  result.node_at.reserve(n);
  std::vector<int> trial_marks(n, 0), is_placed(n, 0);
  int mark = 0;
  for (Index i = 0; i < graph.num_nodes(); ++i) {
    if (is_placed[i] != 0) continue;
    result.node_at.push_back(far_end(graph, i, trial_marks, mark));
    is_placed[result.node_at.back()] = 1;
    append_layers(graph, result.node_at.size() - 1, is_placed, 1, result.node_at, result.layer_begin);
  }
  std::ranges::reverse(result.node_at);
  for (Index& end : result.layer_begin) end = graph.num_nodes() - end;  // ends become beginnings
  std::ranges::reverse(result.layer_begin);
  result.layer_begin.push_back(graph.num_nodes());
  return result;
}

std::vector<Index> inverse_of(std::span<const Index> node_at) {
  std::vector<Index> position(node_at.size());
  for (std::size_t i = 0; i < node_at.size(); ++i) position[node_at[i]] = static_cast<Index>(i);
  return position;
}

#ifdef RESILIN_HAS_METIS

// By METIS_NodeNDP, which orders as METIS_NodeND does and, asked for one part, gives the same order. The
// latter puts handlers of its own in the place of the program's while it works: SIGTERM then ends the
// ordering and is lost, and is undefined where another thread gets it.
std::vector<Index> fill_reducing_order(const NodeGraph& graph) {
  // METIS draws from the one sequence of random numbers that a process has, which it begins anew each time:
  // of two calls at once each would draw what the other leaves, and orders would go by chance.
  static std::mutex turn;
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
  // METIS complains of memory on its own and by signals: it is asked for before. Its graphs, from fine to
  // coarse and cut in two, take some five times the first one; the workspace about as much.
  constexpr std::size_t small = std::size_t{1} << 20, graphs = 6;
  if (!can_allocate(small + graphs * sizeof(idx_t) * (neighbours.size() * 2 + n * 5))) throw std::bad_alloc();
  idx_t sizes[1] = {};
  const std::lock_guard lock(turn);
  METIS_NodeNDP(static_cast<idx_t>(n), begin.data(), neighbours.data(), nullptr, 1, options, node_at.data(),
                position.data(), sizes);
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
