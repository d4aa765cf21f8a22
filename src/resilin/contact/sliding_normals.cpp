#include "resilin/contact/sliding_normals.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "resilin/mesh/facet.hpp"

namespace resilin {
namespace {

/// Cosines of the angles up to which a facet counts whole, and from which it does not count.
constexpr double smooth = 0.8660254037844386, sharp = 0.5;

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

std::span<const Index> facets_of(const CollisionSurface& parts) {
  return parts.dim == 3 ? parts.triangles : parts.edges;
}

}  // namespace

SlidingNormals::SlidingNormals(const CollisionSurface& parts)
    : parts_(parts), row_begin_(parts.num_vertices() + 1) {
  const std::span<const Index> corners = facets_of(parts);
  for (const Index vertex : corners) ++row_begin_[at(vertex) + 1];
  for (std::size_t v = 1; v < row_begin_.size(); ++v) row_begin_[v] += row_begin_[v - 1];
  facets_.resize(corners.size());
  std::vector<std::size_t> next(row_begin_.begin(), row_begin_.end() - 1);
  for (std::size_t k = 0; k < corners.size(); ++k)
    facets_[next[at(corners[k])]++] = static_cast<Index>(k / static_cast<std::size_t>(parts.dim));
}

Vector3 SlidingNormals::of_part(std::span<const Index> vertices, std::span<const double> weights,
                                const Vector3& apart, const VectorX& places) const {
  const std::span<const Index> corners = facets_of(parts_);
  const CellKind kind = parts_.dim == 3 ? CellKind::triangle : CellKind::line;
  const auto dim = static_cast<std::size_t>(parts_.dim);
  Vector3 sum = Vector3::Zero();
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    if (weights[i] == 0) continue;
    Vector3 around = Vector3::Zero();
    double area = 0;
    for (std::size_t k = row_begin_[at(vertices[i])]; k < row_begin_[at(vertices[i]) + 1]; ++k) {
      const Vector3 normal =
          area_vector(parts_.dim, kind, corners.subspan(at(facets_[k]) * dim, dim), places);
      const double size = normal.norm(), along = normal.dot(apart);
      const double share =
          size > 0 ? std::clamp((std::abs(along) / size - sharp) / (smooth - sharp), 0.0, 1.0) : 0;
      around += std::copysign(share, along) * normal + (1 - share) * size * apart;
      area += size;
    }
    sum += std::abs(weights[i]) * (area > 0 ? Vector3(around / area) : apart);
  }
  return sum.normalized();
}

Vector3 SlidingNormals::normal_at(const PartForce& pair, const VectorX& places) const {
  const auto split = static_cast<std::size_t>(num_first(pair.kind)),
             count = static_cast<std::size_t>(num_vertices(pair.kind));
  const auto of = [&](std::size_t begin, std::size_t end) {
    return of_part(std::span(pair.vertices).subspan(begin, end - begin),
                   std::span(pair.weights).subspan(begin, end - begin), pair.normal, places);
  };
  if (pair.kind != PairKind::edge_edge) return of(split, count);
  return (of(0, split) + of(split, count)).normalized();
}

}  // namespace resilin
