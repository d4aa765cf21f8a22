#include "resilin/energy/ring_loads.hpp"

#include <array>
#include <cmath>
#include <numbers>

namespace resilin {
namespace {

/// A point of a boundary line: weight on [0, 1], N_a and dN_a/dxi.
struct LinePoint {
  double weight;
  std::array<double, 3> N, dN;
};

/// Gauss points that integrate N_a r dr/dxi exactly on quadratic lines (degree 5).
std::array<LinePoint, 3> line_points(CellKind kind) {
  const double offset = 0.5 * std::sqrt(0.6);
  std::array<LinePoint, 3> points{};
  for (std::size_t q = 0; q < 3; ++q) {
    const double xi = 0.5 + (static_cast<double>(q) - 1) * offset, weight = q == 1 ? 4.0 / 9 : 2.5 / 9;
    if (kind == CellKind::line)
      points[q] = {weight, {1 - xi, xi, 0}, {-1, 1, 0}};
    else
      points[q] = {weight,
                   {(1 - xi) * (1 - 2 * xi), xi * (2 * xi - 1), 4 * xi * (1 - xi)},
                   {4 * xi - 3, 4 * xi - 1, 4 - 8 * xi}};
  }
  return points;
}

/// Position and tangent dx/dxi at a point of a line.
struct LineState {
  double r = 0, z = 0, dr = 0, dz = 0;
  LineState(const LinePoint& point, std::span<const Index> nodes, const VectorX& x) {
    for (std::size_t a = 0; a < nodes.size(); ++a) {
      const double ra = x[2 * Eigen::Index{nodes[a]}], za = x[2 * Eigen::Index{nodes[a]} + 1];
      r += point.N[a] * ra;
      z += point.N[a] * za;
      dr += point.dN[a] * ra;
      dz += point.dN[a] * za;
    }
  }
  /// 2 pi r n ds/dxi, n outward.
  Eigen::Vector2d area() const { return 2 * std::numbers::pi * r * Eigen::Vector2d(dz, -dr); }
};

/// Calls `body(nodes, point)` for the points of all lines.
template <class Body>
void for_each_line_point(const CellBlock& facets, const Body& body) {
  const auto points = line_points(facets.kind);
  for (Index facet = 0; facet < facets.num_cells(); ++facet)
    for (const LinePoint& point : points) body(facets.cell(facet), point);
}

}  // namespace

void RingTraction::add_forces(const Vector3& value, const VectorX& X, VectorX& forces) const {
  double scale = 1;
  if (is_total_) {
    double area = 0;
    for_each_line_point(facets_, [&](std::span<const Index> nodes, const LinePoint& point) {
      area += point.weight * LineState(point, nodes, X).area().norm();
    });
    scale = 1 / area;
  }
  for_each_line_point(facets_, [&](std::span<const Index> nodes, const LinePoint& point) {
    const double area = scale * point.weight * LineState(point, nodes, X).area().norm();
    for (std::size_t a = 0; a < nodes.size(); ++a)
      forces.segment(2 * Eigen::Index{nodes[a]}, 2) += point.N[a] * area * value.head(2);
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
  for_each_line_point(facets_, [&](std::span<const Index> nodes, const LinePoint& point) {
    const LineState start(point, nodes, from), half(point, nodes, middle), end(point, nodes, to);
    const Eigen::Vector2d mean = (start.area() + 4 * half.area() + end.area()) / 6;
    work += point.weight * mean.dot(Eigen::Vector2d(end.r - start.r, end.z - start.z));
  });
  return p * work;
}

void RingPressure::add_gradient(const VectorX& x, const Conditions& c, VectorX& gradient) const {
  const double p = factor(c);
  if (p == 0) return;
  for_each_line_point(facets_, [&](std::span<const Index> nodes, const LinePoint& point) {
    const Eigen::Vector2d force = p * point.weight * LineState(point, nodes, x).area();
    for (std::size_t a = 0; a < nodes.size(); ++a)
      gradient.segment(2 * Eigen::Index{nodes[a]}, 2) += point.N[a] * force;
  });
}

void RingPressure::add_gradient_magnitude(const VectorX& x, const Conditions& c, VectorX& magnitude) const {
  const double p = std::abs(factor(c));
  if (p == 0) return;
  for_each_line_point(facets_, [&](std::span<const Index> nodes, const LinePoint& point) {
    const Eigen::Vector2d force = p * point.weight * LineState(point, nodes, x).area().cwiseAbs();
    for (std::size_t a = 0; a < nodes.size(); ++a)
      magnitude.segment(2 * Eigen::Index{nodes[a]}, 2) += std::abs(point.N[a]) * force;
  });
}

void RingPressure::add_pattern(BlockPatternBuilder& builder) const {
  for (Index facet = 0; facet < facets_.num_cells(); ++facet) {
    const std::span<const Index> nodes = facets_.cell(facet);
    for (std::size_t a = 0; a < nodes.size(); ++a)
      for (std::size_t b = a + 1; b < nodes.size(); ++b) builder.add_pair(nodes[a], nodes[b]);
  }
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
    for (const LinePoint& point : line_points(facets_.kind)) {
      const LineState at(point, nodes, x);
      std::array<Eigen::Matrix2d, 3> slopes;
      for (std::size_t b = 0; b < count; ++b) {
        slopes[b] << point.N[b] * at.dz, at.r * point.dN[b], -point.N[b] * at.dr - at.r * point.dN[b], 0;
        slopes[b] *= std::numbers::pi * p * point.weight;  // half of 2 pi
      }
      for (std::size_t a = 0; a < count; ++a)
        for (std::size_t b = a; b < count; ++b)
          blocks[a * count + b] += point.N[a] * slopes[b] + point.N[b] * slopes[a].transpose();
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
