#include <algorithm>
#include <map>
#include <numeric>
#include <utility>

#include "resilin/mesh/topology.hpp"

// A pinch of cells in space shows on their boundary: at such a vertex it has several fans of sides, at such
// an edge more than two sides. Only there are the cells themselves looked at.

namespace resilin {
namespace {

using Edge = std::array<Index, 2>;

Edge edge_of(Index a, Index b) { return {std::min(a, b), std::max(a, b)}; }

std::span<const Index> corners_of(const CellBlock& block, Index cell) {
  return block.cell(cell).first(static_cast<std::size_t>(num_corners(block.kind)));
}

/// Whether the cells fall into groups without a common corner other than those of `place`.
bool fall_apart(const CellBlock& block, std::span<const Index> cells, std::span<const Index> place) {
  if (cells.size() < 2) return false;
  std::vector<std::pair<Index, std::size_t>> cells_at;  // corner, position of a cell in the list
  for (std::size_t i = 0; i < cells.size(); ++i)
    for (const Index node : corners_of(block, cells[i]))
      if (std::ranges::find(place, node) == place.end()) cells_at.emplace_back(node, i);
  std::ranges::sort(cells_at);
  std::vector<std::size_t> group(cells.size());  // by cell: one of its group before it, or itself
  std::iota(group.begin(), group.end(), std::size_t{0});
  const auto first_of = [&group](std::size_t i) {
    while (group[i] != i) i = group[i] = group[group[i]];
    return i;
  };
  std::size_t num_groups = cells.size();
  for (std::size_t i = 1; i < cells_at.size(); ++i) {
    if (cells_at[i].first != cells_at[i - 1].first) continue;
    const std::size_t a = first_of(cells_at[i - 1].second), b = first_of(cells_at[i].second);
    if (a == b) continue;
    group[std::max(a, b)] = std::min(a, b);
    --num_groups;
  }
  return num_groups > 1;
}

/// Places that may be pinches.
struct Suspects {
  std::vector<bool> vertices;
  std::map<Edge, std::vector<Index>> edges;  ///< with room for their cells
};

Suspects suspects_on_boundary(const CellBlock& block, Index num_vertices) {
  Suspects suspects{std::vector<bool>(static_cast<std::size_t>(num_vertices), false), {}};
  const CellBlock sides = boundary(block).facets;
  std::vector<std::vector<Index>> sides_at(static_cast<std::size_t>(num_vertices));
  std::vector<Edge> edges;
  for (Index side = 0; side < sides.num_cells(); ++side) {
    const auto corners = corners_of(sides, side);
    for (std::size_t i = 0; i < corners.size(); ++i) {
      sides_at[static_cast<std::size_t>(corners[i])].push_back(side);
      edges.push_back(edge_of(corners[i], corners[(i + 1) % corners.size()]));
    }
  }
  for (Index v = 0; v < num_vertices; ++v) {
    const auto at = static_cast<std::size_t>(v);
    suspects.vertices[at] = fall_apart(sides, sides_at[at], std::span(&v, 1));
  }
  std::ranges::sort(edges);
  for (std::size_t i = 2; i < edges.size(); ++i)
    if (edges[i] == edges[i - 2]) suspects.edges[edges[i]];
  return suspects;
}

}  // namespace

Pinches find_pinches(const CellBlock& block, Index num_vertices) {
  Suspects suspects;
  if (dimension(block.kind) == 3) {
    suspects = suspects_on_boundary(block, num_vertices);
  } else {
    suspects.vertices.assign(static_cast<std::size_t>(num_vertices), true);
  }
  std::vector<std::vector<Index>> cells_at(static_cast<std::size_t>(num_vertices));
  for (Index cell = 0; cell < block.num_cells(); ++cell) {
    for (const Index node : corners_of(block, cell))
      if (suspects.vertices[static_cast<std::size_t>(node)])
        cells_at[static_cast<std::size_t>(node)].push_back(cell);
    if (suspects.edges.empty()) continue;
    for (const auto& [i, j] : cell_edges(block.kind)) {
      const auto nodes = block.cell(cell);
      const auto found = suspects.edges.find(
          edge_of(nodes[static_cast<std::size_t>(i)], nodes[static_cast<std::size_t>(j)]));
      if (found != suspects.edges.end()) found->second.push_back(cell);
    }
  }
  Pinches pinches;
  for (Index v = 0; v < num_vertices; ++v)
    if (fall_apart(block, cells_at[static_cast<std::size_t>(v)], std::span(&v, 1)))
      pinches.vertices.push_back(v);
  for (const auto& [edge, cells] : suspects.edges)
    if (fall_apart(block, cells, edge)) pinches.edges.push_back(edge);
  return pinches;
}

}  // namespace resilin
