#include "resilin/mesh/facet.hpp"

#include <Eigen/Geometry>
#include <cmath>
#include <map>

#include "resilin/element/catalog.hpp"

namespace resilin {
namespace {

/// Shape functions of a line on [0, 1] with its second end at 1 and, of second order, its third node at 1/2.
FacetPoint line_point(CellKind kind, double xi, double weight) {
  if (kind == CellKind::line) return {weight, {1 - xi, xi}, {-1, 0, 1, 0}};
  return {weight,
          {(1 - xi) * (1 - 2 * xi), xi * (2 * xi - 1), 4 * xi * (1 - xi)},
          {4 * xi - 3, 0, 4 * xi - 1, 0, 4 - 8 * xi, 0}};
}

std::vector<FacetPoint> line_points(CellKind kind) {
  if (kind == CellKind::line) return {line_point(kind, 0.5, 1)};
  const double offset = 0.5 / std::sqrt(3.0);  // Gauss, exact to degree 3
  return {line_point(kind, 0.5 - offset, 0.5), line_point(kind, 0.5 + offset, 0.5)};
}

std::vector<FacetPoint> face_points(const ElementInfo& element) {
  // Degree of N_a times that of two tangents, whose product has the degree of the Jacobian.
  const int degree = element.degree + element.jacobian_degree();
  std::vector<FacetPoint> points;
  for (const QuadraturePoint& at : rule_of_degree(element.shape, degree).points) {
    FacetPoint point{at.weight, {}, {}};
    element.shape_values(at.xi, point.values);
    element.shape_gradients(at.xi, point.slopes);
    points.push_back(point);
  }
  return points;
}

/// Points of lines and of the cells of every plane element.
std::map<CellKind, std::vector<FacetPoint>> points_of_all_kinds() {
  std::map<CellKind, std::vector<FacetPoint>> points;
  for (const CellKind kind : {CellKind::line, CellKind::line3}) points[kind] = line_points(kind);
  for (const ElementInfo* element : elements())
    if (element->dim == 2) points.try_emplace(cell_kind(*element), face_points(*element));
  return points;
}

}  // namespace

const std::vector<FacetPoint>& facet_points(CellKind kind) {
  static const std::map<CellKind, std::vector<FacetPoint>> points = points_of_all_kinds();
  return points.at(kind);
}

Vector3 node_position(int dim, Index node, const VectorX& x) {
  Vector3 position = Vector3::Zero();
  position.head(dim) = x.segment(Eigen::Index{node} * dim, dim);
  return position;
}

Vector3 area_vector(int dim, const FacetPoint& point, std::span<const Index> nodes, const VectorX& x) {
  Vector3 first = Vector3::Zero(), second = Vector3::Zero();
  for (std::size_t a = 0; a < nodes.size(); ++a) {
    const Vector3 position = node_position(dim, nodes[a], x);
    first += point.slopes[2 * a] * position;
    second += point.slopes[2 * a + 1] * position;
  }
  if (dim == 2) return {first.y(), -first.x(), 0};
  return first.cross(second);
}

Vector3 area_vector(int dim, CellKind kind, std::span<const Index> nodes, const VectorX& x) {
  Vector3 sum = Vector3::Zero();
  for (const FacetPoint& point : facet_points(kind)) sum += point.weight * area_vector(dim, point, nodes, x);
  return sum;
}

}  // namespace resilin
