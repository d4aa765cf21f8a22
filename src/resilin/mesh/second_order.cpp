#include "resilin/mesh/second_order.hpp"

#include <algorithm>

#include "resilin/mesh/topology.hpp"

namespace resilin {
namespace {

using Edge = std::array<Index, 2>;

Edge sorted_edge(std::span<const Index> cell, const std::array<int, 2>& corners) {
  const Index a = cell[static_cast<std::size_t>(corners[0])], b = cell[static_cast<std::size_t>(corners[1])];
  return {std::min(a, b), std::max(a, b)};
}

/// Edges with the nodes in their middles, sorted by their ends.
class Middles {
 public:
  void add(const Edge& edge, Index middle) { entries_.push_back({edge, middle}); }

  /// Where several nodes claim one edge, the one that was added first stays.
  void sort() {
    std::ranges::stable_sort(entries_, {}, &Entry::edge);
    const auto surplus = std::ranges::unique(entries_, {}, &Entry::edge);
    entries_.erase(surplus.begin(), surplus.end());
  }

  Index find(const Edge& edge) const {  ///< -1 when there is none
    const auto found = std::ranges::lower_bound(entries_, edge, {}, &Entry::edge);
    return found != entries_.end() && found->edge == edge ? found->middle : -1;
  }

 private:
  struct Entry {
    Edge edge;
    Index middle;
  };
  std::vector<Entry> entries_;
};

Middles middles_of_second_order_cells(const Mesh& mesh) {
  Middles middles;
  for (const CellBlock& block : mesh.blocks) {
    if (!is_second_order(block.kind)) continue;
    const auto corners = static_cast<std::size_t>(num_corners(block.kind));
    const auto local_edges = cell_edges(block.kind);
    for (Index cell = 0; cell < block.num_cells(); ++cell)
      for (std::size_t e = 0; e < local_edges.size(); ++e)
        middles.add(sorted_edge(block.cell(cell), local_edges[e]), block.cell(cell)[corners + e]);
  }
  middles.sort();
  return middles;
}

bool gains_nodes(const CellBlock& block) { return second_order(block.kind) != block.kind; }

/// Edges of first-order cells that have no node yet, sorted.
std::vector<Edge> edges_without_node(const Mesh& mesh, const Middles& middles) {
  std::vector<Edge> bare;
  for (const CellBlock& block : mesh.blocks) {
    if (!gains_nodes(block)) continue;
    for (const Edge& edge : edges(block))
      if (middles.find(edge) < 0) bare.push_back(edge);
  }
  std::ranges::sort(bare);
  const auto surplus = std::ranges::unique(bare);
  bare.erase(surplus.begin(), surplus.end());
  return bare;
}

std::vector<Index> with_middles(const CellBlock& block, const Middles& middles) {
  std::vector<Index> nodes;
  for (Index cell = 0; cell < block.num_cells(); ++cell) {
    const std::span<const Index> corners = block.cell(cell);
    nodes.insert(nodes.end(), corners.begin(), corners.end());
    for (const auto& edge : cell_edges(block.kind)) nodes.push_back(middles.find(sorted_edge(corners, edge)));
  }
  return nodes;
}

void sort_unique(std::vector<Index>& list) {
  std::ranges::sort(list);
  const auto surplus = std::ranges::unique(list);
  list.erase(surplus.begin(), surplus.end());
}

/// Adds the nodes of the group's cells, or of edges between its vertices when it has no cells.
void complete_group(Group& group, const Mesh& mesh) {
  bool has_cells = false;
  for (std::size_t b = 0; b < group.cells.size(); ++b)
    for (const Index cell : group.cells[b]) {
      has_cells = true;
      const std::span<const Index> nodes = mesh.blocks[b].cell(cell);
      group.vertices.insert(group.vertices.end(), nodes.begin(), nodes.end());
    }
  if (!has_cells) {
    std::vector<bool> is_in_group(mesh.vertices.size(), false);
    for (const Index v : group.vertices) is_in_group[static_cast<std::size_t>(v)] = true;
    for (const CellBlock& block : mesh.blocks) {
      if (!is_second_order(block.kind) || cell_sides(block.kind).empty()) continue;
      const std::vector<Index> between = middles_between(block, is_in_group);
      group.vertices.insert(group.vertices.end(), between.begin(), between.end());
    }
  }
  sort_unique(group.vertices);
}

}  // namespace

SecondOrderMesh second_order(const Mesh& mesh) {
  SecondOrderMesh result{mesh, {}};
  Mesh& finer = result.mesh;
  Middles middles = middles_of_second_order_cells(mesh);
  result.ends = edges_without_node(mesh, middles);
  for (const Edge& edge : result.ends) {
    middles.add(edge, static_cast<Index>(finer.vertices.size()));
    finer.vertices.push_back(0.5 * (mesh.vertices[static_cast<std::size_t>(edge[0])] +
                                    mesh.vertices[static_cast<std::size_t>(edge[1])]));
  }
  middles.sort();
  for (CellBlock& block : finer.blocks) {
    if (!gains_nodes(block) || mesh.find_block(second_order(block.kind)) != nullptr) continue;
    block = {second_order(block.kind), with_middles(block, middles)};
  }
  for (Group& group : finer.groups) complete_group(group, finer);
  return result;
}

std::vector<Index> middles_between(const CellBlock& cells, const std::vector<bool>& is_in_set) {
  const auto is_in = [](const std::vector<bool>& set, Index node) {
    return set[static_cast<std::size_t>(node)];
  };
  const CellBlock surface = boundary(cells).facets;
  std::vector<bool> is_on_surface(is_in_set.size(), false);
  for (const Index node : surface.nodes) is_on_surface[static_cast<std::size_t>(node)] = true;
  std::vector<Index> middles;
  const auto collect = [&](const CellBlock& block, bool is_surface) {
    const auto corners = static_cast<std::size_t>(num_corners(block.kind));
    const auto local_edges = cell_edges(block.kind);
    for (Index cell = 0; cell < block.num_cells() && is_second_order(block.kind); ++cell)
      for (std::size_t e = 0; e < local_edges.size(); ++e) {
        const auto [a, b] = sorted_edge(block.cell(cell), local_edges[e]);
        if (!is_in(is_in_set, a) || !is_in(is_in_set, b)) continue;
        const bool passes_inside = is_in(is_on_surface, a) && is_in(is_on_surface, b);
        if (is_surface || !passes_inside) middles.push_back(block.cell(cell)[corners + e]);
      }
  };
  collect(surface, true);
  collect(cells, false);
  sort_unique(middles);
  return middles;
}

}  // namespace resilin
