#include "resilin/contact/crossing.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <span>
#include <vector>

#include "resilin/core/orientation.hpp"
#include "resilin/core/parallel.hpp"
#include "resilin/mesh/box_tree.hpp"
#include "resilin/mesh/facet.hpp"

namespace resilin {
namespace {

constexpr std::size_t edges_per_task = 256;
constexpr double beside_bound = 1e-14;  // bound relative to a product's size: some tens of its roundings
constexpr Index none = std::numeric_limits<Index>::max();

/// Whether a segment lies beyond one side of a triangle by more than round-off: so do almost all of the pairs
/// that share a plane, of which only exact sums would tell that they do not cross.
bool is_beside(const Vector3& p, const Vector3& q, const std::array<Vector3, 3>& triangle) {
  const Vector3 normal = (triangle[1] - triangle[0]).cross(triangle[2] - triangle[0]);
  for (std::size_t k = 0; k < 3; ++k) {
    const Vector3& corner = triangle[k];
    const Vector3 outwards = (triangle[(k + 1) % 3] - corner).cross(normal);
    const std::array<Vector3, 4> to = {p - corner, q - corner, triangle[(k + 1) % 3] - corner,
                                       triangle[(k + 2) % 3] - corner};
    double reach = 0;
    for (const Vector3& arrow : to) reach = std::max(reach, arrow.squaredNorm());
    const double round_off = beside_bound * outwards.norm() * std::sqrt(reach);
    const double nearest = std::min(outwards.dot(to[0]), outwards.dot(to[1]));
    if (nearest > std::max({0.0, outwards.dot(to[2]), outwards.dot(to[3])}) + round_off) return true;
  }
  return false;
}

/// Whether a segment goes through a triangle's inside.
bool goes_through(const Vector3& p, const Vector3& q, const std::array<Vector3, 3>& triangle) {
  if (is_beside(p, q, triangle)) return false;
  const auto& [a, b, c] = triangle;
  if (orientation(a, b, c, p) * orientation(a, b, c, q) >= 0) return false;
  const std::array<int, 3> sides = {orientation(p, q, a, b), orientation(p, q, b, c),
                                    orientation(p, q, c, a)};
  const auto [least, most] = std::ranges::minmax(sides);
  return least >= 0 || most <= 0;
}

bool cross(const std::array<Eigen::Vector2d, 2>& s, const std::array<Eigen::Vector2d, 2>& t) {
  return orientation(s[0], s[1], t[0]) * orientation(s[0], s[1], t[1]) < 0 &&
         orientation(t[0], t[1], s[0]) * orientation(t[0], t[1], s[1]) < 0;
}

class CrossingSearch {
 public:
  CrossingSearch(const CollisionSurface& surface, const BodyMeetings& meetings, const VectorX& places)
      : surface_(surface), meetings_(meetings), places_(places) {
    const std::size_t corners = surface.dim == 3 ? 3 : 2;
    const std::vector<Index>& parts = surface.dim == 3 ? surface.triangles : surface.edges;
    std::vector<Box> boxes(parts.size() / corners);
    for (std::size_t i = 0; i < parts.size(); ++i) boxes[i / corners].add(place(parts[i]));
    tree_ = BoxTree(boxes);
  }

  /// First triangle that an edge goes through, the lowest number; `none` for nothing.
  Index first_through(Index edge) const {
    const std::span<const Index> ends = std::span(surface_.edges).subspan(2 * at(edge), 2);
    Box box;
    for (const Index end : ends) box.add(place(end));
    Index first = none;
    tree_.visit_meeting(box, [&](Index other) {
      if (other < first && are_crossing(ends, other, edge)) first = other;
    });
    return first;
  }

 private:
  static std::size_t at(Index i) { return static_cast<std::size_t>(i); }
  Vector3 place(Index vertex) const { return node_position(surface_.dim, vertex, places_); }
  Eigen::Vector2d place_2d(Index vertex) const { return places_.segment<2>(Eigen::Index{vertex} * 2); }

  bool are_crossing(std::span<const Index> ends, Index other, Index edge) const {
    const std::size_t corners = surface_.dim == 3 ? 3 : 2;
    const std::vector<Index>& parts = surface_.dim == 3 ? surface_.triangles : surface_.edges;
    if (surface_.dim == 2 && other <= edge) return false;  // once is enough
    const std::span<const Index> part = std::span(parts).subspan(corners * at(other), corners);
    if (!meetings_.meet(surface_.bodies[at(ends[0])], surface_.bodies[at(part[0])])) return false;
    for (const Index corner : part)
      if (corner == ends[0] || corner == ends[1]) return false;
    if (surface_.dim == 3)
      return goes_through(place(ends[0]), place(ends[1]), {place(part[0]), place(part[1]), place(part[2])});
    return cross({place_2d(ends[0]), place_2d(ends[1])}, {place_2d(part[0]), place_2d(part[1])});
  }

  const CollisionSurface& surface_;
  const BodyMeetings& meetings_;
  const VectorX& places_;
  BoxTree tree_;
};

/// Whether a ray along x from a point goes out of a body's surface once more than into it.
bool is_inside_2d(const CollisionSurface& surface, Index body, const Eigen::Vector2d& point,
                  const VectorX& places) {
  bool is_inside = false;
  for (std::size_t i = 0; i < surface.edges.size(); i += 2) {
    if (surface.bodies[static_cast<std::size_t>(surface.edges[i])] != body) continue;
    const Eigen::Vector2d a = places.segment<2>(Eigen::Index{surface.edges[i]} * 2),
                          b = places.segment<2>(Eigen::Index{surface.edges[i + 1]} * 2);
    if ((a.y() > point.y()) == (b.y() > point.y())) continue;
    if ((orientation(a, b, point) > 0) == (b.y() > a.y())) is_inside = !is_inside;
  }
  return is_inside;
}

/// Whether a body's surface goes around a point.
bool is_inside_3d(const CollisionSurface& surface, Index body, const Vector3& point, const VectorX& places) {
  double turns = 0;
  for (std::size_t i = 0; i < surface.triangles.size(); i += 3) {
    if (surface.bodies[static_cast<std::size_t>(surface.triangles[i])] != body) continue;
    std::array<Vector3, 3> to;
    for (std::size_t k = 0; k < 3; ++k) to[k] = node_position(3, surface.triangles[i + k], places) - point;
    const auto& [a, b, c] = to;
    const double la = a.norm(), lb = b.norm(), lc = c.norm();
    turns += std::atan2(a.dot(b.cross(c)), la * lb * lc + a.dot(b) * lc + a.dot(c) * lb + b.dot(c) * la) /
             (2 * std::numbers::pi);
  }
  return std::abs(turns) > 0.5;  // whatever its orientation
}

/// One vertex of each connected piece of a body's surface.
std::vector<Index> piece_vertices(const CollisionSurface& surface, Index body) {
  std::vector<Index> leader(surface.num_vertices());
  std::iota(leader.begin(), leader.end(), Index{0});
  const auto find = [&](Index v) {
    while (leader[static_cast<std::size_t>(v)] != v)
      v = leader[static_cast<std::size_t>(v)] =
          leader[static_cast<std::size_t>(leader[static_cast<std::size_t>(v)])];
    return v;
  };
  for (std::size_t i = 0; i < surface.edges.size(); i += 2)
    leader[static_cast<std::size_t>(find(surface.edges[i]))] = find(surface.edges[i + 1]);
  std::vector<Index> vertices;
  for (const Index v : surface.points)
    if (surface.bodies[static_cast<std::size_t>(v)] == body && find(v) == v) vertices.push_back(v);
  return vertices;
}

}  // namespace

std::array<Index, 2> vertices_of(const Crossing& crossing, const CollisionSurface& surface) {
  const std::vector<Index>& others = surface.dim == 3 ? surface.triangles : surface.edges;
  return {surface.edges[static_cast<std::size_t>(2 * crossing.edge)],
          others[static_cast<std::size_t>(surface.dim * crossing.other)]};
}

bool is_inside(const CollisionSurface& surface, Index body, const Vector3& point, const VectorX& places) {
  return surface.dim == 3 ? is_inside_3d(surface, body, point, places)
                          : is_inside_2d(surface, body, point.head<2>(), places);
}

std::optional<Vector3> place_of_piece_inside(const CollisionSurface& surface, Index body, Index other,
                                             const VectorX& places) {
  for (const Index vertex : piece_vertices(surface, body)) {
    Vector3 place = node_position(surface.dim, vertex, places);
    if (is_inside(surface, other, place, places)) return place;
  }
  return std::nullopt;
}

bool has_piece_inside(const CollisionSurface& surface, Index body, Index other, const VectorX& places) {
  return place_of_piece_inside(surface, body, other, places).has_value();
}

std::optional<Crossing> first_crossing(const CollisionSurface& surface, const BodyMeetings& meetings,
                                       const VectorX& places) {
  const CrossingSearch search(surface, meetings, places);
  const std::size_t num_edges = surface.edges.size() / 2;
  std::vector<Index> through(num_edges);
  parallel_for(num_edges, edges_per_task, [&](std::size_t begin, std::size_t end) {
    for (std::size_t edge = begin; edge < end; ++edge)
      through[edge] = search.first_through(static_cast<Index>(edge));
  });
  const auto found = std::ranges::find_if(through, [](Index other) { return other != none; });
  if (found == through.end()) return std::nullopt;
  return Crossing{static_cast<Index>(found - through.begin()), *found};
}

}  // namespace resilin
