#include "resilin/mesh/collapsed_cell.hpp"

#include <algorithm>
#include <set>

namespace resilin {
namespace {

using Sides = std::vector<std::vector<Index>>;

/// By positions in the cell's node list, outward for a positive volume.
std::vector<std::vector<int>> side_positions(CellKind kind) {
  switch (first_order(kind)) {
    case CellKind::tetrahedron:
      return {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
    case CellKind::pyramid:
      return {{0, 3, 2, 1}, {0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}};
    case CellKind::prism:
      return {{0, 2, 1}, {3, 4, 5}, {0, 1, 4, 3}, {1, 2, 5, 4}, {2, 0, 3, 5}};
    case CellKind::hexahedron:
      return {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}};
    default:
      return {};
  }
}

/// A polygon without corners that are the one before them; empty where it is folded upon itself.
std::vector<Index> without_repetitions(std::vector<Index> polygon) {
  polygon.erase(std::unique(polygon.begin(), polygon.end()), polygon.end());
  while (polygon.size() > 1 && polygon.front() == polygon.back()) polygon.pop_back();
  const std::set<Index> distinct(polygon.begin(), polygon.end());
  if (distinct.size() < 3 || distinct.size() < polygon.size()) return {};
  return polygon;
}

bool all_differ(std::span<const Index> nodes) {
  for (std::size_t i = 1; i < nodes.size(); ++i)
    for (std::size_t k = 0; k < i; ++k)
      if (nodes[i] == nodes[k]) return false;
  return true;
}

bool has(const std::vector<Index>& polygon, Index vertex) {
  return std::ranges::find(polygon, vertex) != polygon.end();
}

CellOfCorners cell_of(CellKind kind, std::span<const Index> nodes) {
  CellOfCorners cell{kind};
  std::ranges::copy(nodes, cell.nodes.begin());
  return cell;
}

/// The vertex beside `corner` in one of the quadrilaterals that is not of the triangle; -1 when there is
/// none.
Index opposite(const Sides& sides, const std::vector<Index>& triangle, Index corner) {
  for (const std::vector<Index>& side : sides) {
    if (side.size() != 4 || !has(side, corner)) continue;
    const auto at = static_cast<std::size_t>(std::ranges::find(side, corner) - side.begin());
    for (const std::size_t beside : {(at + 1) % 4, (at + 3) % 4})
      if (!has(triangle, side[beside])) return side[beside];
  }
  return -1;
}

std::optional<CellOfCorners> prism_of(const Sides& sides) {
  std::vector<std::vector<Index>> triangles;
  for (const std::vector<Index>& side : sides)
    if (side.size() == 3) triangles.push_back(side);
  const std::vector<Index>& below = triangles[0];
  std::array<Index, 6> nodes{};
  constexpr std::array<std::size_t, 3> inward = {0, 2, 1};
  for (std::size_t i = 0; i < 3; ++i) {
    nodes[i] = below[inward[i]];
    nodes[3 + i] = opposite(sides, below, nodes[i]);
    if (!has(triangles[1], nodes[3 + i])) return std::nullopt;
  }
  return all_differ(nodes) ? std::optional(cell_of(CellKind::prism, nodes)) : std::nullopt;
}

}  // namespace

std::vector<std::vector<Index>> sides_of_different_corners(CellKind kind, std::span<const Index> nodes) {
  Sides sides;
  for (const std::vector<int>& positions : side_positions(kind)) {
    std::vector<Index> polygon;
    for (const int position : positions) polygon.push_back(nodes[static_cast<std::size_t>(position)]);
    polygon = without_repetitions(std::move(polygon));
    if (!polygon.empty()) sides.push_back(std::move(polygon));
  }
  return sides;
}

std::optional<CellOfCorners> cell_of_different_corners(CellKind kind, std::span<const Index> nodes) {
  const bool may_collapse = kind == CellKind::hexahedron || kind == CellKind::prism ||
                            kind == CellKind::pyramid || kind == CellKind::quadrilateral;
  if (!may_collapse || all_differ(nodes)) return std::nullopt;
  if (kind == CellKind::quadrilateral) {
    const std::vector<Index> corners = without_repetitions({nodes.begin(), nodes.end()});
    return corners.size() == 3 ? std::optional(cell_of(CellKind::triangle, corners)) : std::nullopt;
  }
  const Sides sides = sides_of_different_corners(kind, nodes);
  const std::set<Index> distinct(nodes.begin(), nodes.end());
  const auto num_triangles =
      std::ranges::count_if(sides, [](const std::vector<Index>& side) { return side.size() == 3; });
  const auto num_quadrilaterals = static_cast<std::ptrdiff_t>(sides.size()) - num_triangles;
  const auto beyond = [&](const std::vector<Index>& side) {
    return *std::ranges::find_if(distinct, [&](Index vertex) { return !has(side, vertex); });
  };
  if (distinct.size() == 4 && num_triangles == 4 && num_quadrilaterals == 0) {
    const std::vector<Index>& side = sides[0];
    return cell_of(CellKind::tetrahedron, std::array{side[0], side[2], side[1], beyond(side)});
  }
  if (distinct.size() == 5 && num_triangles == 4 && num_quadrilaterals == 1) {
    const std::vector<Index>& base =
        *std::ranges::find_if(sides, [](const std::vector<Index>& side) { return side.size() == 4; });
    return cell_of(CellKind::pyramid, std::array{base[0], base[3], base[2], base[1], beyond(base)});
  }
  if (distinct.size() == 6 && num_triangles == 2 && num_quadrilaterals == 3) return prism_of(sides);
  return std::nullopt;
}

}  // namespace resilin
