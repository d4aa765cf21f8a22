#include "resilin/energy/spread_force.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>
#include <span>
#include <utility>

#include "resilin/element/catalog.hpp"

namespace resilin {
namespace {

/// Points on [0, 1] that are exact to degree 5.
std::vector<FacetPoint> points_of_line(CellKind kind) {
  std::vector<FacetPoint> points;
  const double offset = 0.5 * std::sqrt(0.6);
  for (const auto& [xi, weight] :
       {std::pair{0.5 - offset, 5.0 / 18}, std::pair{0.5, 8.0 / 18}, std::pair{0.5 + offset, 5.0 / 18}}) {
    if (kind == CellKind::line) {
      points.push_back({weight, {1 - xi, xi}, {-1, 0, 1, 0}});
    } else {
      points.push_back({weight,
                        {(1 - xi) * (1 - 2 * xi), xi * (2 * xi - 1), 4 * xi * (1 - xi)},
                        {4 * xi - 3, 0, 4 * xi - 1, 0, 4 - 8 * xi, 0}});
    }
  }
  return points;
}

std::vector<FacetPoint> moment_points(CellKind kind) {
  if (dimension(kind) == 1) return points_of_line(kind);
  const ElementInfo& element = *element_of_cells(kind);
  std::vector<FacetPoint> points;
  for (const QuadraturePoint& at :
       rule_of_degree(element.shape, 2 * element.degree + element.jacobian_degree()).points) {
    FacetPoint point{at.weight, {}, {}};
    element.shape_values(at.xi, point.values);
    element.shape_gradients(at.xi, point.slopes);
    points.push_back(point);
  }
  return points;
}

/// The sum of shape functions times values at nodes.
Vector3 value_at(int dim, const FacetPoint& point, std::span<const Index> nodes, const VectorX& values) {
  Vector3 sum = Vector3::Zero();
  for (std::size_t a = 0; a < nodes.size(); ++a)
    sum += point.values[a] * node_position(dim, nodes[a], values);
  return sum;
}

/// Calls `body(nodes, point, area, X)` at the points of all facets, `area` times a function being its
/// integral.
template <class Body>
void for_each_spread_point(int dim, const CellBlock& facets, std::span<const FacetPoint> points,
                           const VectorX& X, const Body& body) {
  for (Index facet = 0; facet < facets.num_cells(); ++facet) {
    const std::span<const Index> nodes = facets.cell(facet);
    for (const FacetPoint& point : points)
      body(nodes, point, point.weight * area_vector(dim, point, nodes, X).norm(),
           value_at(dim, point, nodes, X));
  }
}

/// Slopes of the area at a point by the positions of its nodes.
std::array<Vector3, max_facet_nodes> slopes_of_area(int dim, std::span<const Index> nodes,
                                                    const FacetPoint& point, const VectorX& X) {
  const auto of_vector = area_vector_slopes(dim, point, nodes, X);
  const Vector3 direction = area_vector(dim, point, nodes, X).normalized();
  std::array<Vector3, max_facet_nodes> slopes;
  for (std::size_t b = 0; b < nodes.size(); ++b)
    slopes[b] = point.weight * of_vector[b].transpose() * direction;
  return slopes;
}

double change_of_area(int dim, std::span<const Index> nodes, const FacetPoint& point, const VectorX& X,
                      const VectorX& change) {
  const auto slopes = slopes_of_area(dim, nodes, point, X);
  double sum = 0;
  for (std::size_t b = 0; b < nodes.size(); ++b) sum += slopes[b].dot(node_position(dim, nodes[b], change));
  return sum;
}

Eigen::Matrix3d inertia_of(const Vector3& r) {
  return r.squaredNorm() * Eigen::Matrix3d::Identity() - r * r.transpose();
}

}  // namespace

SpreadForce::SpreadForce(Kind kind, int dim, CellBlock facets, const std::optional<Vector3>& point)
    : kind_(kind),
      dim_(dim),
      facets_(std::move(facets)),
      point_(point),
      points_(moment_points(facets_.kind)) {}

SpreadForce::Geometry SpreadForce::geometry(const VectorX& X) const {
  Geometry found;
  const auto visit = [&](const auto& body) { for_each_spread_point(dim_, facets_, points_, X, body); };
  visit([&](std::span<const Index>, const FacetPoint&, double area, const Vector3& at) {
    found.area += area;
    found.center += area * at;
  });
  found.center /= found.area;
  if (turns())
    visit([&](std::span<const Index>, const FacetPoint&, double area, const Vector3& at) {
      found.inertia += area * inertia_of(at - found.center);
    });
  return found;
}

Vector3 SpreadForce::solve(const Eigen::Matrix3d& inertia, const Vector3& moment) const {
  if (!turns()) return Vector3::Zero();
  if (dim_ == 2) return {0, 0, moment.z() / inertia(2, 2)};
  return inertia.inverse() * moment;
}

Vector3 SpreadForce::moment(const Vector3& value, const Vector3& center) const {
  if (is_moment()) return value;
  return point_ ? Vector3((*point_ - center).cross(value)) : Vector3(Vector3::Zero());
}

SpreadForce::Traction SpreadForce::traction(const Vector3& value, const VectorX& X) const {
  const Geometry on = geometry(X);
  return {force(value) / on.area, solve(on.inertia, moment(value, on.center)), on.center};
}

void SpreadForce::add_forces(const Vector3& value, const VectorX& X, VectorX& forces) const {
  const Traction traction = this->traction(value, X);
  for_each_spread_point(
      dim_, facets_, points_, X,
      [&](std::span<const Index> nodes, const FacetPoint& point, double area, const Vector3& at) {
        const Vector3 on_point = area * traction.at(at);
        for (std::size_t a = 0; a < nodes.size(); ++a)
          forces.segment(Eigen::Index{nodes[a]} * dim_, dim_) += point.values[a] * on_point.head(dim_);
      });
}

/// With r = X - c: dt = -F dA / A^2 + dw x r + w x dr and J dw = dM - dJ w.
void SpreadForce::add_force_change(const Vector3& value, const VectorX& X, const VectorX& change,
                                   VectorX& forces) const {
  const Geometry on = geometry(X);
  const Vector3 F = force(value), spin = solve(on.inertia, moment(value, on.center));
  const auto visit = [&](const auto& body) { for_each_spread_point(dim_, facets_, points_, X, body); };
  double d_area = 0;
  Vector3 d_center = Vector3::Zero();
  visit([&](std::span<const Index> nodes, const FacetPoint& point, double area, const Vector3& at) {
    const double d = change_of_area(dim_, nodes, point, X, change);
    d_area += d;
    d_center += d * (at - on.center) + area * value_at(dim_, point, nodes, change);
  });
  d_center /= on.area;
  Vector3 d_spin = Vector3::Zero();
  if (turns()) {
    Vector3 d_moment = is_moment() ? Vector3(Vector3::Zero()) : Vector3(-d_center.cross(F));
    visit([&](std::span<const Index> nodes, const FacetPoint& point, double area, const Vector3& at) {
      const Vector3 r = at - on.center, dr = value_at(dim_, point, nodes, change) - d_center;
      d_moment -= change_of_area(dim_, nodes, point, X, change) * (inertia_of(r) * spin);
      d_moment -= area * (2 * r.dot(dr) * spin - dr * r.dot(spin) - r * dr.dot(spin));
    });
    d_spin = solve(on.inertia, d_moment);
  }
  visit([&](std::span<const Index> nodes, const FacetPoint& point, double area, const Vector3& at) {
    const Vector3 r = at - on.center, dr = value_at(dim_, point, nodes, change) - d_center;
    const Vector3 on_point = change_of_area(dim_, nodes, point, X, change) * (F / on.area + spin.cross(r)) +
                             area * (-d_area / (on.area * on.area) * F + d_spin.cross(r) + spin.cross(dr));
    for (std::size_t a = 0; a < nodes.size(); ++a)
      forces.segment(Eigen::Index{nodes[a]} * dim_, dim_) += point.values[a] * on_point.head(dim_);
  });
}

/// The transpose of the change above, from w . f back to X.
void SpreadForce::add_rest_slopes(const Vector3& value, const VectorX& X, const VectorX& w,
                                  VectorX& slopes) const {
  const Geometry on = geometry(X);
  const Vector3 F = force(value), spin = solve(on.inertia, moment(value, on.center));
  const auto visit = [&](const auto& body) { for_each_spread_point(dim_, facets_, points_, X, body); };
  Vector3 sum = Vector3::Zero(), by_spin = Vector3::Zero();
  visit([&](std::span<const Index> nodes, const FacetPoint& point, double area, const Vector3& at) {
    const Vector3 y = value_at(dim_, point, nodes, w);
    sum += area * y;
    by_spin += area * (at - on.center).cross(y);
  });
  const Vector3 back = solve(on.inertia, by_spin);  // by the moment
  const auto by_arm = [&](double area, const Vector3& r, const Vector3& y) {
    return Vector3(area * (y.cross(spin) - 2 * back.dot(spin) * r + back * r.dot(spin) + spin * back.dot(r)));
  };
  Vector3 by_center = point_ && !is_moment() ? Vector3(back.cross(F)) : Vector3(Vector3::Zero());
  visit([&](std::span<const Index> nodes, const FacetPoint& point, double area, const Vector3& at) {
    by_center -= by_arm(area, at - on.center, value_at(dim_, point, nodes, w));
  });
  const double by_area = -sum.dot(F) / (on.area * on.area) - by_center.dot(on.center) / on.area;
  visit([&](std::span<const Index> nodes, const FacetPoint& point, double area, const Vector3& at) {
    const Vector3 r = at - on.center, y = value_at(dim_, point, nodes, w);
    const double by_part = y.dot(F / on.area + spin.cross(r)) - back.dot(inertia_of(r) * spin) + by_area +
                           by_center.dot(at) / on.area;
    const Vector3 by_place = by_arm(area, r, y) + area / on.area * by_center;
    const auto areas = slopes_of_area(dim_, nodes, point, X);
    for (std::size_t b = 0; b < nodes.size(); ++b)
      slopes.segment(Eigen::Index{nodes[b]} * dim_, dim_) +=
          point.values[b] * by_place.head(dim_) + by_part * areas[b].head(dim_);
  });
}

Vector3 SpreadForce::value_slopes(int dim, const VectorX& X, const VectorX& w) const {
  Vector3 slopes = Vector3::Zero();
  for (int k = 0; k < 3; ++k) {
    if (dim == 2 && (k == 2) != is_moment()) continue;
    VectorX forces = VectorX::Zero(w.size());
    add_forces(Vector3::Unit(k), X, forces);
    slopes[k] = forces.dot(w);
  }
  return slopes;
}

}  // namespace resilin
