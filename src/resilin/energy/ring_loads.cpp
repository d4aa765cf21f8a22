#include "resilin/energy/ring_loads.hpp"

#include <array>
#include <cmath>
#include <numbers>

#include "resilin/mesh/depth.hpp"

namespace resilin {
namespace {

/// Points that integrate N_a r dr/dxi exactly.
const std::vector<FacetPoint>& line_points(CellKind kind) { return facet_points(kind, {.is_turned = true}); }

/// Position and tangent dx/dxi at a point of a line.
struct LineState {
  double r = 0, z = 0, dr = 0, dz = 0;
  LineState(const FacetPoint& point, std::span<const Index> nodes, const VectorX& x) {
    for (std::size_t a = 0; a < nodes.size(); ++a) {
      const double ra = x[2 * Eigen::Index{nodes[a]}], za = x[2 * Eigen::Index{nodes[a]} + 1];
      r += point.values[a] * ra;
      z += point.values[a] * za;
      dr += point.slopes[2 * a] * ra;
      dz += point.slopes[2 * a] * za;
    }
  }
  /// 2 pi r n ds/dxi, n outward.
  Eigen::Vector2d area() const { return 2 * std::numbers::pi * r * Eigen::Vector2d(dz, -dr); }
};

/// Calls `body(nodes, point)` for the points of all lines.
template <class Body>
void for_each_line_point(const CellBlock& facets, const Body& body) {
  const std::vector<FacetPoint>& points = line_points(facets.kind);
  for (Index facet = 0; facet < facets.num_cells(); ++facet)
    for (const FacetPoint& point : points) body(facets.cell(facet), point);
}

}  // namespace

void RingTraction::add_forces(const Vector3& value, const VectorX& X, VectorX& forces) const {
  double scale = 1;
  if (is_total_) {
    double area = 0;
    for_each_line_point(facets_, [&](std::span<const Index> nodes, const FacetPoint& point) {
      area += point.weight * LineState(point, nodes, X).area().norm();
    });
    scale = 1 / area;
  }
  for_each_line_point(facets_, [&](std::span<const Index> nodes, const FacetPoint& point) {
    const double area = scale * point.weight * LineState(point, nodes, X).area().norm();
    for (std::size_t a = 0; a < nodes.size(); ++a)
      forces.segment(2 * Eigen::Index{nodes[a]}, 2) += point.values[a] * area * value.head(2);
  });
}

RingPressure::RingPressure(std::string name, CellBlock facets, double pressure, VectorX rest_positions,
                           ActiveTime active)
    : name_(std::move(name)),
      facets_(std::move(facets)),
      pressure_(pressure),
      rest_positions_(std::move(rest_positions)),
      active_(std::move(active)) {}

/// Work along the straight path: the force is quadratic in it, so that Simpson's rule is exact.
double RingPressure::difference(const VectorX& from, const VectorX& to, const Conditions& c) const {
  const double p = factor(c);
  if (p == 0) return 0;
  const VectorX middle = 0.5 * (from + to);
  double work = 0;
  for_each_line_point(facets_, [&](std::span<const Index> nodes, const FacetPoint& point) {
    const LineState start(point, nodes, from), half(point, nodes, middle), end(point, nodes, to);
    const Eigen::Vector2d mean = (start.area() + 4 * half.area() + end.area()) / 6;
    work += point.weight * mean.dot(Eigen::Vector2d(end.r - start.r, end.z - start.z));
  });
  return p * work;
}

void RingPressure::add_gradient(const VectorX& x, const Conditions& c, VectorX& gradient) const {
  if (const double p = factor(c); p != 0) add_forces(x, -p, gradient);
}

void RingPressure::add_full_forces(const VectorX& x, VectorX& forces) const {
  add_forces(x, pressure_, forces);
}

void RingPressure::add_forces(const VectorX& x, double pressure, VectorX& forces) const {
  for_each_line_point(facets_, [&](std::span<const Index> nodes, const FacetPoint& point) {
    const Eigen::Vector2d force = -pressure * point.weight * LineState(point, nodes, x).area();
    for (std::size_t a = 0; a < nodes.size(); ++a)
      forces.segment(2 * Eigen::Index{nodes[a]}, 2) += point.values[a] * force;
  });
}

void RingPressure::add_gradient_magnitude(const VectorX& x, const Conditions& c, VectorX& magnitude) const {
  const double p = std::abs(factor(c));
  if (p == 0) return;
  for_each_line_point(facets_, [&](std::span<const Index> nodes, const FacetPoint& point) {
    const Eigen::Vector2d force = p * point.weight * LineState(point, nodes, x).area().cwiseAbs();
    for (std::size_t a = 0; a < nodes.size(); ++a)
      magnitude.segment(2 * Eigen::Index{nodes[a]}, 2) += std::abs(point.values[a]) * force;
  });
}

void RingPressure::add_pattern(BlockPatternBuilder& builder) const {
  for (Index facet = 0; facet < facets_.num_cells(); ++facet) builder.add_clique(facets_.cell(facet));
}

/// Symmetric part of the tangent. With A = 2 pi r (z', -r'): dA/dr_b = 2 pi (N_b z', -N_b r' - r N_b'),
/// dA/dz_b = 2 pi (r N_b', 0).
void RingPressure::add_hessian(const VectorX& x, const Conditions& c, Projection,
                               BlockMatrix& hessian) const {
  const double p = factor(c);
  if (p == 0) return;
  for (Index facet = 0; facet < facets_.num_cells(); ++facet) {
    const std::span<const Index> nodes = facets_.cell(facet);
    const std::size_t count = nodes.size();
    std::array<Eigen::Matrix2d, 9> blocks;
    blocks.fill(Eigen::Matrix2d::Zero());
    for (const FacetPoint& point : line_points(facets_.kind)) {
      const LineState at(point, nodes, x);
      std::array<Eigen::Matrix2d, 3> slopes;
      for (std::size_t b = 0; b < count; ++b) {
        slopes[b] << point.values[b] * at.dz, at.r * point.slopes[2 * b],
            -point.values[b] * at.dr - at.r * point.slopes[2 * b], 0;
        slopes[b] *= std::numbers::pi * p * point.weight;  // half of 2 pi
      }
      for (std::size_t a = 0; a < count; ++a)
        for (std::size_t b = a; b < count; ++b)
          blocks[a * count + b] += point.values[a] * slopes[b] + point.values[b] * slopes[a].transpose();
    }
    for (std::size_t a = 0; a < count; ++a)
      for (std::size_t b = a; b < count; ++b) {
        const Eigen::Matrix2d& block = blocks[a * count + b];
        const std::array<double, 4> values = {block(0, 0), block(0, 1), block(1, 0), block(1, 1)};
        hessian.add_block(nodes[a], nodes[b], values.data());
      }
  }
}

std::optional<double> RingPressure::driven_work(const VectorX& from, const Conditions& before,
                                                const VectorX& to, const Conditions& after) const {
  if (active_.is_always()) return std::nullopt;
  return larger_work(*this, from, before, to, after);
}

}  // namespace resilin
