#include "resilin/mesh/overlap.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <vector>

#include "resilin/mesh/box_tree.hpp"

namespace resilin {
namespace {

constexpr double touching_share = 1e-3;  ///< tolerance relative to a cell's size

/// A tetrahedron, in 2D a triangle.
struct Simplex {
  Index cell = 0;
  int num_corners = 4;
  std::array<Vector3, 4> corners;
  Box box;

  double size() const { return (box.max - box.min).norm(); }
};

using Corners = std::array<int, 4>;

/// Hexahedra by the six tetrahedra around the diagonal from corner 0 to corner 6.
std::span<const Corners> simplices_of(CellKind kind) {
  static constexpr std::array<Corners, 1> whole = {{{0, 1, 2, 3}}};
  static constexpr std::array<Corners, 2> quadrilateral = {{{0, 1, 2, -1}, {0, 2, 3, -1}}};
  static constexpr std::array<Corners, 6> hexahedron = {
      {{0, 1, 2, 6}, {0, 2, 3, 6}, {0, 3, 7, 6}, {0, 7, 4, 6}, {0, 4, 5, 6}, {0, 5, 1, 6}}};
  switch (first_order(kind)) {
    case CellKind::quadrilateral:
      return quadrilateral;
    case CellKind::hexahedron:
      return hexahedron;
    default:
      return whole;
  }
}

Vector3 place_of(const PlacedCells& cells, Index node) {
  const auto dim = static_cast<std::size_t>(dimension(cells.kind));
  Vector3 place = Vector3::Zero();
  for (std::size_t i = 0; i < dim; ++i)
    place[static_cast<Eigen::Index>(i)] = cells.positions[static_cast<std::size_t>(node) * dim + i];
  return place;
}

Box box_around(const PlacedCells& cells) {
  Box box;
  for (const Index node : cells.nodes) box.add(place_of(cells, node));
  return box;
}

/// Those that meet a box.
std::vector<Simplex> simplices_in(const PlacedCells& cells, const Box& region) {
  const auto width = static_cast<std::size_t>(num_nodes(cells.kind));
  std::vector<Simplex> simplices;
  for (std::size_t first = 0; first < cells.nodes.size(); first += width)
    for (const Corners& corners : simplices_of(cells.kind)) {
      Simplex simplex{.cell = static_cast<Index>(first / width),
                      .num_corners = dimension(cells.kind) + 1,
                      .corners = {},
                      .box = {}};
      for (std::size_t i = 0; i < static_cast<std::size_t>(simplex.num_corners); ++i) {
        simplex.corners[i] = place_of(cells, cells.nodes[first + static_cast<std::size_t>(corners[i])]);
        simplex.box.add(simplex.corners[i]);
      }
      if (simplex.box.meets(region)) simplices.push_back(simplex);
    }
  return simplices;
}

/// The directions along which two convex bodies without a common point are apart: normals of sides, and in
/// space of pairs of edges.
template <class Visit>
bool all_directions(const Simplex& a, const Simplex& b, const Visit& visit) {
  const auto edges = [](const Simplex& s, const auto& each) {
    for (std::size_t i = 0; i < static_cast<std::size_t>(s.num_corners); ++i)
      for (std::size_t k = i + 1; k < static_cast<std::size_t>(s.num_corners); ++k)
        if (!each(Vector3(s.corners[k] - s.corners[i]))) return false;
    return true;
  };
  if (a.num_corners == 3) {
    const auto across = [&](const Vector3& edge) { return visit(Vector3(edge.y(), -edge.x(), 0)); };
    return edges(a, across) && edges(b, across);
  }
  for (const Simplex* s : {&a, &b})
    for (std::size_t i = 0; i < 4; ++i) {
      const Vector3 &p = s->corners[(i + 1) % 4], &q = s->corners[(i + 2) % 4], &r = s->corners[(i + 3) % 4];
      if (!visit(Vector3((q - p).cross(r - p)))) return false;
    }
  return edges(a, [&](const Vector3& of_a) {
    return edges(b, [&](const Vector3& of_b) { return visit(Vector3(of_a.cross(of_b))); });
  });
}

/// Whether they share more than what touching and rounding make (separating axes, Gottschalk et al. 1996).
bool share_space(const Simplex& a, const Simplex& b) {
  const double slack = touching_share * std::min(a.size(), b.size());
  return all_directions(a, b, [&](const Vector3& direction) {
    const double length = direction.norm();
    if (!(length > 1e-12 * a.size() * (a.num_corners == 3 ? 1 : b.size()))) return true;  // edges in parallel
    const auto range = [&](const Simplex& s) {
      std::array<double, 2> ends = {s.corners[0].dot(direction), s.corners[0].dot(direction)};
      for (std::size_t i = 1; i < static_cast<std::size_t>(s.num_corners); ++i) {
        const double at = s.corners[i].dot(direction);
        ends = {std::min(ends[0], at), std::max(ends[1], at)};
      }
      return ends;
    };
    const auto [low_a, high_a] = range(a);
    const auto [low_b, high_b] = range(b);
    return std::min(high_a, high_b) - std::max(low_a, low_b) > slack * length;
  });
}

}  // namespace

std::optional<Overlap> find_overlap(const PlacedCells& cells, const PlacedCells& others) {
  const Box box = box_around(cells), other_box = box_around(others);
  if (!box.meets(other_box)) return std::nullopt;
  const std::vector<Simplex> near = simplices_in(cells, other_box), far = simplices_in(others, box);
  std::vector<Box> boxes;
  for (const Simplex& simplex : far) boxes.push_back(simplex.box);
  const BoxTree tree(boxes);
  for (const Simplex& simplex : near) {
    std::optional<Overlap> found;
    tree.visit_meeting(simplex.box, [&](Index i) {
      const Simplex& other = far[static_cast<std::size_t>(i)];
      if ((found && other.cell >= found->other) || !share_space(simplex, other)) return;
      const Vector3 low = simplex.box.min.cwiseMax(other.box.min),
                    high = simplex.box.max.cwiseMin(other.box.max);
      found = {.cell = simplex.cell, .other = other.cell, .place = 0.5 * (low + high)};
    });
    if (found) return found;
  }
  return std::nullopt;
}

std::vector<ComponentOverlap> overlapping_components(const Mesh& mesh, const CellBlock& block,
                                                     const Components& components, std::size_t most) {
  if (components.count < 2) return {};
  std::vector<double> positions;
  for (const Vector3& X : mesh.vertices)
    positions.insert(positions.end(), X.data(), X.data() + dimension(block.kind));
  std::vector<std::vector<Index>> members(static_cast<std::size_t>(components.count)), nodes = members;
  for (Index cell = 0; cell < block.num_cells(); ++cell) {
    const auto c = static_cast<std::size_t>(components.of_cell[static_cast<std::size_t>(cell)]);
    members[c].push_back(cell);
    nodes[c].insert(nodes[c].end(), block.cell(cell).begin(), block.cell(cell).end());
  }
  std::vector<Box> boxes;
  for (const auto& list : nodes) boxes.push_back(box_around({block.kind, list, positions}));
  const BoxTree tree(boxes);
  std::vector<ComponentOverlap> result;
  for (std::size_t a = 0; a < nodes.size() && result.size() < most; ++a) {
    std::vector<std::size_t> near;
    tree.visit_meeting(boxes[a], [&](Index b) {
      if (static_cast<std::size_t>(b) > a) near.push_back(static_cast<std::size_t>(b));
    });
    std::ranges::sort(near);
    for (const std::size_t b : near) {
      const auto found = find_overlap({block.kind, nodes[a], positions}, {block.kind, nodes[b], positions});
      if (!found || result.size() == most) continue;
      result.push_back({.components = {static_cast<Index>(a), static_cast<Index>(b)},
                        .cells = {members[a][static_cast<std::size_t>(found->cell)],
                                  members[b][static_cast<std::size_t>(found->other)]}});
    }
  }
  return result;
}

}  // namespace resilin
