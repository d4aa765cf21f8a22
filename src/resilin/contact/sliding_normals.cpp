#include "resilin/contact/sliding_normals.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "resilin/contact/cross_matrix.hpp"
#include "resilin/mesh/facet.hpp"

namespace resilin {
namespace {

/// Cosines of the angles up to which a facet counts whole, and from which it does not count.
constexpr double smooth = 0.8660254037844386, sharp = 0.5;

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

std::span<const Index> facets_of(const CollisionSurface& parts) {
  return parts.dim == 3 ? parts.triangles : parts.edges;
}

/// One that has a part in the normal of a corner.
struct Facet {
  Vector3 normal;      ///< times its area
  double size, sign;   ///< its area; of its normal along the way apart
  double along_share;  ///< as far as it is turned from that way, 1 or more: it counts whole
  double share;        ///< share of its own normal, the rest that of the way apart

  Facet(const Vector3& area, const Vector3& apart)
      : normal(area), size(area.norm()), sign(std::copysign(1.0, area.dot(apart))) {
    along_share = size > 0 ? (std::abs(area.dot(apart)) / size - sharp) / (smooth - sharp) : 0;
    share = std::clamp(along_share, 0.0, 1.0);
  }
  Vector3 part(const Vector3& apart) const { return sign * share * normal + (1 - share) * size * apart; }
  /// By the cosine of the angle.
  double slope_of_share() const { return along_share > 0 && along_share < 1 ? 1 / (smooth - sharp) : 0; }
};

/// d(area vector)/d(place of a corner).
Eigen::Matrix3d area_slopes(int dim, std::span<const Index> nodes, std::size_t corner,
                            const VectorX& places) {
  if (dim == 2) {
    Eigen::Matrix3d turn = Eigen::Matrix3d::Zero();
    turn(0, 1) = corner == 1 ? 1 : -1;
    turn(1, 0) = -turn(0, 1);
    return turn;
  }
  const Vector3 next = node_position(dim, nodes[(corner + 1) % 3], places),
                last = node_position(dim, nodes[(corner + 2) % 3], places);
  return 0.5 * cross_matrix(last - next);
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
      const Facet facet(area_vector(parts_.dim, kind, corners.subspan(at(facets_[k]) * dim, dim), places),
                        apart);
      around += facet.part(apart);
      area += facet.size;
    }
    sum += std::abs(weights[i]) * (area > 0 ? Vector3(around / area) : apart);
  }
  return sum.normalized();
}

// Slopes of what `of_part` says; those by the weights and by the normal of the pair are added to those of
// `slopes`, those by the places appended.
Vector3 SlidingNormals::add_slopes_of_part(const PartForce& pair, std::size_t begin, std::size_t end,
                                           const VectorX& places, Slopes& slopes) const {
  const std::span<const Index> corners = facets_of(parts_);
  const CellKind kind = parts_.dim == 3 ? CellKind::triangle : CellKind::line;
  const auto dim = static_cast<std::size_t>(parts_.dim);
  const Eigen::Matrix3d I = Eigen::Matrix3d::Identity();
  const Vector3& apart = pair.normal;
  Vector3 sum = Vector3::Zero();
  Eigen::Matrix3d by_apart = Eigen::Matrix3d::Zero();
  std::array<Vector3, most_pair_vertices> by_weights{};
  by_weights.fill(Vector3::Zero());
  std::vector<std::pair<Index, Eigen::Matrix3d>> by_places;
  for (std::size_t i = begin; i < end; ++i) {
    const double weight = std::abs(pair.weights[i]);
    if (weight == 0) continue;
    Vector3 around = Vector3::Zero();
    double area = 0;
    const std::size_t row = row_begin_[at(pair.vertices[i])], row_end = row_begin_[at(pair.vertices[i]) + 1];
    for (std::size_t k = row; k < row_end; ++k) {
      const Facet facet(area_vector(parts_.dim, kind, corners.subspan(at(facets_[k]) * dim, dim), places),
                        apart);
      around += facet.part(apart);
      area += facet.size;
    }
    const Vector3 mean = area > 0 ? Vector3(around / area) : apart;
    sum += weight * mean;
    by_weights[i] = std::copysign(1.0, pair.weights[i]) * mean;
    if (!(area > 0)) by_apart += weight * I;
    for (std::size_t k = row; k < row_end && area > 0; ++k) {
      const std::span<const Index> nodes = corners.subspan(at(facets_[k]) * dim, dim);
      const Facet facet(area_vector(parts_.dim, kind, nodes, places), apart);
      if (!(facet.size > 0)) continue;
      const Vector3 turned = facet.sign * facet.normal - facet.size * apart, unit = facet.normal / facet.size;
      const double slope = facet.slope_of_share() * facet.sign / facet.size;
      by_apart +=
          weight / area * (slope * turned * facet.normal.transpose() + (1 - facet.share) * facet.size * I);
      const Vector3 of_share = slope * (apart - unit.dot(apart) * unit);
      const Eigen::Matrix3d by_normal =
          weight / area *
          (turned * of_share.transpose() + facet.sign * facet.share * I +
           (1 - facet.share) * apart * unit.transpose() - mean * unit.transpose());
      for (std::size_t corner = 0; corner < dim; ++corner)
        by_places.emplace_back(nodes[corner], by_normal * area_slopes(parts_.dim, nodes, corner, places));
    }
  }
  const Vector3 normal = sum.normalized();
  const Eigen::Matrix3d P = (I - normal * normal.transpose()) / sum.norm();
  slopes.normal += P * by_apart;
  for (std::size_t i = begin; i < end; ++i) slopes.weights[i] = P * by_weights[i];
  for (const auto& [vertex, slope] : by_places) slopes.places.emplace_back(vertex, P * slope);
  return normal;
}

SlidingNormals::Slopes SlidingNormals::slopes_at(const PartForce& pair, const VectorX& places) const {
  const auto split = static_cast<std::size_t>(num_first(pair.kind)),
             count = static_cast<std::size_t>(num_vertices(pair.kind));
  Slopes slopes;
  slopes.weights.fill(Vector3::Zero());
  if (pair.kind != PairKind::edge_edge) {
    add_slopes_of_part(pair, split, count, places, slopes);
    return slopes;
  }
  const Vector3 sum = add_slopes_of_part(pair, 0, split, places, slopes) +
                      add_slopes_of_part(pair, split, count, places, slopes);
  const Vector3 normal = sum.normalized();
  const Eigen::Matrix3d P = (Eigen::Matrix3d::Identity() - normal * normal.transpose()) / sum.norm();
  slopes.normal = P * slopes.normal;
  for (Vector3& slope : slopes.weights) slope = P * slope;
  for (auto& [vertex, slope] : slopes.places) slope = P * slope;
  return slopes;
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
