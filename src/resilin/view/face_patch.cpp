#include "resilin/view/face_patch.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <optional>
#include <utility>

#include "resilin/core/error.hpp"

namespace resilin {
namespace {

Vector3 place_of(std::span<const float> positions, std::uint32_t vertex) {
  return Eigen::Map<const Eigen::Vector3f>(positions.data() + 3 * std::size_t{vertex}).cast<double>();
}

/// A triangle or, in 2D, an edge of the rim, which repeats its second corner.
struct Facet {
  std::size_t number = 0;
  std::array<std::uint32_t, 3> corners = {};
};

/// The facets of a part: triangles, in 2D the edges that one triangle alone has, or those of a skin of lines.
std::vector<Facet> facets_of(const ShownSurface& surface, const ShownSurface::Part& part) {
  const auto triangles = surface.triangles().subspan(static_cast<std::size_t>(part.first_triangle),
                                                     static_cast<std::size_t>(part.num_triangles));
  std::vector<Facet> facets;
  if (surface.dimension() == 3) {
    for (std::size_t t = 0; t < triangles.size(); ++t)
      facets.push_back({static_cast<std::size_t>(part.first_triangle) + t, triangles[t]});
    return facets;
  }
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::pair<int, Facet>> uses;
  for (const auto& [a, b, c] : triangles)
    for (const auto& [from, to] : {std::pair(a, b), std::pair(b, c), std::pair(c, a)}) {
      auto& [count, facet] = uses[std::minmax(from, to)];
      ++count;
      facet.corners = {from, to, to};
    }
  for (auto& [edge, use] : uses)
    if (use.first == 1) facets.push_back(use.second);
  if (triangles.empty())
    for (const auto& [a, b] : surface.edges().subspan(static_cast<std::size_t>(part.first_edge),
                                                      static_cast<std::size_t>(part.num_edges)))
      facets.push_back({0, {a, b, b}});
  for (std::size_t f = 0; f < facets.size(); ++f) facets[f].number = f;
  return facets;
}

/// Not of length 1; zero where a facet has no extent.
Vector3 normal_of(const Facet& facet, std::span<const float> rest, int dim) {
  const Vector3 A = place_of(rest, facet.corners[0]);
  const Vector3 u = place_of(rest, facet.corners[1]) - A;
  return dim == 2 ? Vector3(u.y(), -u.x(), 0) : Vector3(u.cross(place_of(rest, facet.corners[2]) - A));
}

Vector3 middle_of(const Facet& facet, std::span<const float> rest, int dim) {
  Vector3 sum = Vector3::Zero();
  for (int i = 0; i < dim; ++i) sum += place_of(rest, facet.corners[static_cast<std::size_t>(i)]);
  return sum / dim;
}

double distance_to_edge(const Vector3& X, const Vector3& a, const Vector3& b) {
  const double length = (b - a).squaredNorm();
  const double share = length > 0 ? std::clamp((X - a).dot(b - a) / length, 0.0, 1.0) : 0.0;
  return (a + share * (b - a) - X).norm();
}

/// Where a patch begins, and the place at rest from which its radius counts.
struct Seed {
  std::size_t facet = 0;  ///< in the list of the part
  Vector3 place = Vector3::Zero();
};

std::optional<Seed> seed_in_plane(const std::vector<Facet>& facets, const Vector3& place,
                                  std::span<const float> positions, std::span<const float> rest) {
  std::optional<Seed> seed;
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t f = 0; f < facets.size(); ++f) {
    const double distance = distance_to_edge(place, place_of(positions, facets[f].corners[0]),
                                             place_of(positions, facets[f].corners[1]));
    if (!(distance < nearest)) continue;
    nearest = distance;
    seed = Seed{f, middle_of(facets[f], rest, 2)};
  }
  return seed;
}

std::optional<Seed> seed_in_space(const ShownSurface& surface, const ShownSurface::Part& part, Index vertex,
                                  const Vector3& place, std::span<const float> positions) {
  const ShownSurface::Touch touched = surface.touch(vertex, place, positions);
  Seed seed;
  for (std::size_t i = 0; i < 3; ++i)
    seed.place += touched.shares[i] * place_of(surface.rest_positions(), touched.corners[i]);
  const auto first = static_cast<std::size_t>(part.first_triangle);
  for (std::size_t f = 0; f < static_cast<std::size_t>(part.num_triangles); ++f) {
    const auto& corners = surface.triangles()[first + f];
    const bool is_it = touched.triangle
                           ? *touched.triangle == first + f
                           : std::ranges::find(corners, static_cast<std::uint32_t>(vertex)) != corners.end();
    if (!is_it) continue;
    seed.facet = f;
    return seed;
  }
  return std::nullopt;
}

/// Corners at the same place under one number, so that seams do not part a face.
std::vector<std::uint32_t> joined_corners(const ShownSurface::Part& part, std::span<const float> rest) {
  std::map<std::array<float, 3>, std::uint32_t> places;
  std::vector<std::uint32_t> joined(static_cast<std::size_t>(part.num_vertices));
  for (std::size_t v = 0; v < joined.size(); ++v) {
    const float* X = rest.data() + 3 * (static_cast<std::size_t>(part.first_vertex) + v);
    joined[v] = places.try_emplace({X[0], X[1], X[2]}, static_cast<std::uint32_t>(v)).first->second;
  }
  return joined;
}

/// Neighbours of facets: those that share an edge, in 2D a corner.
class Neighbours {
 public:
  Neighbours(const std::vector<Facet>& facets, const ShownSurface::Part& part, std::span<const float> rest,
             int dim)
      : joined_(joined_corners(part, rest)),
        first_(static_cast<std::uint32_t>(part.first_vertex)),
        dim_(dim) {
    for (std::size_t f = 0; f < facets.size(); ++f)
      for (const Key& key : keys(facets[f])) by_key_[key].push_back(f);
  }

  template <class Visit>
  void for_each(const Facet& facet, const Visit& visit) const {
    for (const Key& key : keys(facet))
      for (const std::size_t other : by_key_.at(key)) visit(other);
  }

 private:
  using Key = std::pair<std::uint32_t, std::uint32_t>;

  std::vector<Key> keys(const Facet& facet) const {
    const auto corner = [&](std::size_t i) { return joined_[facet.corners[i] - first_]; };
    if (dim_ == 2) return {{corner(0), corner(0)}, {corner(1), corner(1)}};
    return {std::minmax(corner(0), corner(1)), std::minmax(corner(1), corner(2)),
            std::minmax(corner(2), corner(0))};
  }

  std::vector<std::uint32_t> joined_;
  std::uint32_t first_;
  int dim_;
  std::map<Key, std::vector<std::size_t>> by_key_;
};

/// The facets, by their places in the list, that hang together with the seed and lie within reach of it.
std::vector<bool> reached(const std::vector<Facet>& facets, const Neighbours& neighbours, const Seed& seed,
                          const FaceReach& reach, std::span<const float> rest, int dim) {
  const Vector3 facing = normal_of(facets[seed.facet], rest, dim).normalized();
  const double least = std::cos(std::min(reach.angle, 180.0) * std::numbers::pi / 180) - 1e-6;
  const auto belongs = [&](const Facet& facet) {
    const Vector3 normal = normal_of(facet, rest, dim);
    const bool is_near =
        !(reach.radius > 0) || (middle_of(facet, rest, dim) - seed.place).norm() <= reach.radius;
    return is_near && normal.dot(facing) >= least * normal.norm();
  };
  std::vector<bool> is_taken(facets.size(), false);
  std::vector<std::size_t> open = {seed.facet};
  is_taken[seed.facet] = true;
  while (!open.empty()) {
    const std::size_t f = open.back();
    open.pop_back();
    neighbours.for_each(facets[f], [&](std::size_t other) {
      if (is_taken[other] || !belongs(facets[other])) return;
      is_taken[other] = true;
      open.push_back(other);
    });
  }
  return is_taken;
}

}  // namespace

FacePatch face_patch(const ShownSurface& surface, Index vertex, const Vector3& place,
                     std::span<const float> positions, const FaceReach& reach) {
  const auto parts = surface.parts();
  const auto part = std::ranges::find_if(
      parts, [vertex](const auto& p) { return vertex < p.first_vertex + p.num_vertices; });
  const int dim = surface.dimension();
  const std::span<const float> rest = surface.rest_positions();
  const std::vector<Facet> facets = facets_of(surface, *part);
  const std::optional<Seed> seed = dim == 2 ? seed_in_plane(facets, place, positions, rest)
                                            : seed_in_space(surface, *part, vertex, place, positions);
  if (!seed)
    throw InputError("hold: vertex", "one of the surface", std::to_string(vertex) + ", which is inside");
  const std::vector<bool> is_taken =
      reached(facets, Neighbours(facets, *part, rest, dim), *seed, reach, rest, dim);
  FacePatch patch;
  patch.part = static_cast<std::size_t>(part - parts.begin());
  patch.touched = facets[seed->facet].number;
  for (std::size_t f = 0; f < facets.size(); ++f) {
    if (!is_taken[f]) continue;
    patch.facets.push_back(facets[f].number);
    for (const std::uint32_t corner : facets[f].corners) patch.vertices.push_back(static_cast<Index>(corner));
  }
  std::ranges::sort(patch.vertices);
  patch.vertices.erase(std::ranges::unique(patch.vertices).begin(), patch.vertices.end());
  return patch;
}

std::vector<Index> nodes_of_patch(const ShownSurface& surface, const FacePatch& patch) {
  constexpr double round_off = 1e-9;  // rounding of weights, which sum to one
  std::vector<Index> nodes;
  for (const Index vertex : patch.vertices) {
    const MaterialPoint point = surface.material_point(vertex);
    for (std::size_t a = 0; a < point.nodes.size(); ++a)
      if (std::abs(point.weights[a]) > round_off) nodes.push_back(point.nodes[a]);
  }
  std::ranges::sort(nodes);
  nodes.erase(std::ranges::unique(nodes).begin(), nodes.end());
  return nodes;
}

}  // namespace resilin
