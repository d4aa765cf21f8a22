#include "resilin/contact/sharpness.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "resilin/mesh/facet.hpp"

namespace resilin {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double round_off = 1e-6;  ///< flatter edges count as flat

double angle_between(const Vector3& a, const Vector3& b) { return std::atan2(a.cross(b).norm(), a.dot(b)); }

double without_round_off(double share) { return share > round_off ? share : 0; }

/// Directions from a part to those beside it: the first two, and how many there are.
struct Fan {
  Vector3 first, second;
  int count = 0;

  void add(const Vector3& direction) {
    (count == 0 ? first : second) = direction;
    ++count;
  }
  /// Fraction that two of them leave free in the plane that they are in; for one, the half away from it.
  double share() const {
    if (count == 0) return 1;
    return count == 2 ? (pi - angle_between(first, second)) / (2 * pi) : 0.5;
  }
};

/// Facets and edges that meet at a vertex.
struct Corner {
  double angles = 0;       ///< sum of the angles of triangles
  bool is_on_rim = false;  ///< on the rim of a surface of triangles
  bool has_triangles = false;
  Fan lines;  ///< edges of no triangle

  double share() const {
    const double of_lines = lines.share();
    if (!has_triangles) return of_lines;
    const double of_triangles =
        is_on_rim ? std::abs(pi - angles) / (2 * pi) : std::abs(2 * pi - angles) / (4 * pi);
    return lines.count > 0 ? std::max(of_lines, of_triangles) : of_triangles;
  }
};

}  // namespace

Sharpness sharpness_of(const CollisionSurface& parts, std::span<const Index> triangle_edges,
                       const VectorX& places) {
  const std::size_t num_edges = parts.edges.size() / 2;
  const auto at = [](Index i) { return static_cast<std::size_t>(i); };
  const auto way = [&](Index from, Index to) {
    return Vector3(node_position(parts.dim, to, places) - node_position(parts.dim, from, places));
  };
  std::vector<Fan> fans(num_edges);
  std::vector<Corner> corners(parts.num_vertices());
  for (std::size_t k = 0; k < triangle_edges.size(); ++k) {
    if (triangle_edges[k] < 0) continue;
    const std::size_t first = k - k % 3;
    const Index a = parts.triangles[k], b = parts.triangles[first + (k + 1) % 3],
                c = parts.triangles[first + (k + 2) % 3];
    if (c == a || c == b) continue;  // an edge by itself
    const Vector3 along = way(a, b), other = way(a, c);
    fans[at(triangle_edges[k])].add(other - other.dot(along) / along.squaredNorm() * along);
    corners[at(a)].angles += angle_between(along, other);
    corners[at(a)].has_triangles = true;
  }
  Sharpness sharpness{.edges = std::vector<double>(parts.dim == 3 ? num_edges : 0),
                      .points = std::vector<double>(parts.num_vertices())};
  for (std::size_t edge = 0; edge < num_edges; ++edge) {
    const Index a = parts.edges[2 * edge], b = parts.edges[2 * edge + 1];
    if (parts.dim == 3) sharpness.edges[edge] = without_round_off(fans[edge].share());
    if (a == b) continue;  // a point by itself in 2D
    if (fans[edge].count == 0) {
      corners[at(a)].lines.add(way(a, b));
      corners[at(b)].lines.add(way(b, a));
    } else if (fans[edge].count == 1) {
      corners[at(a)].is_on_rim = corners[at(b)].is_on_rim = true;
    }
  }
  for (std::size_t v = 0; v < corners.size(); ++v)
    sharpness.points[v] = without_round_off(corners[v].share());
  return sharpness;
}

void turn_tips(const CollisionSurface& parts, const VectorX& places, const Depth& depth,
               Sharpness& sharpness) {
  std::map<Index, Fan> tips;
  for (std::size_t k = 0; k < parts.edges.size(); ++k) {
    const Index tip = parts.edges[k], other = parts.edges[k % 2 == 0 ? k + 1 : k - 1];
    const Vector3 at = node_position(2, tip, places), end = node_position(2, other, places);
    if (!depth.is_on_axis(std::abs(at.x())) || depth.is_on_axis(std::abs(end.x()))) continue;
    const Vector3 way = end - at;
    tips[tip].add(way);
    tips[tip].add({-way.x(), way.y(), 0});
  }
  for (const auto& [tip, fan] : tips)
    if (fan.count == 2) sharpness.points[static_cast<std::size_t>(tip)] = without_round_off(fan.share());
}

}  // namespace resilin
