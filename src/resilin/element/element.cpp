#include "resilin/element/element.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <numbers>

#include "resilin/core/error.hpp"
#include "resilin/core/text.hpp"
#include "resilin/element/axisymmetric.hpp"

namespace resilin {

int ElementInfo::num_corners() const {
  switch (family(shape)) {
    case ShapeFamily::simplices:
      return dim + 1;
    case ShapeFamily::cubes:
      break;
  }
  return 1 << dim;
}

int ElementInfo::jacobian_degree() const {
  switch (family(shape)) {
    case ShapeFamily::simplices:
      return dim * (degree - 1);
    case ShapeFamily::cubes:
      break;
  }
  return dim * degree - 1;
}

std::vector<std::string> ElementInfo::quadrature_names() const {
  // The gradients of simplices of degree 1 are constant: one point is exact, and more would change nothing.
  // With less than the default an element has modes without energy.
  const bool has_one = is_simplex(shape) && degree == 1;
  std::vector<std::string> names;
  for (const QuadratureRule& rule : quadrature_rules(shape)) {
    const bool is_default = rule.name == default_quadrature;
    if (is_default || (!has_one && !names.empty())) names.emplace_back(rule.name);
  }
  return names;
}

const QuadratureRule& ElementInfo::quadrature(std::string_view rule_name, const std::string& place) const {
  const std::string_view wanted = rule_name.empty() ? default_quadrature : rule_name;
  const std::vector<std::string> names = quadrature_names();
  for (const QuadratureRule& rule : quadrature_rules(shape))
    if (rule.name == wanted && std::ranges::find(names, wanted) != names.end()) return rule;
  throw InputError(place, "one of " + join(names) + " for " + std::string(name),
                   "\"" + std::string(rule_name) + "\"");
}

PointGeometry point_geometry(const ElementInfo& element, const QuadraturePoint& point,
                             std::span<const double> rest_positions) {
  const auto dim = static_cast<std::size_t>(element.dim),
             num_nodes = static_cast<std::size_t>(element.num_nodes);
  std::vector<double> reference(dim * num_nodes);
  element.shape_gradients(point.xi, reference);
  // dX/dxi, in 2D with the unit thickness as third direction
  Matrix<3> dX_dxi = Matrix<3>::Zero();
  if (element.dim == 2) dX_dxi(2, 2) = 1;
  for (std::size_t a = 0; a < num_nodes; ++a)
    for (std::size_t i = 0; i < dim; ++i)
      for (std::size_t k = 0; k < dim; ++k)
        dX_dxi(static_cast<int>(i), static_cast<int>(k)) +=
            rest_positions[a * dim + i] * reference[a * dim + k];
  const Matrix<3> dxi_dX = dX_dxi.inverse();
  PointGeometry geometry{point.weight * dX_dxi.determinant(), std::vector<double>(dim * num_nodes, 0.0),
                         dxi_dX};
  if (is_axisymmetric(element)) {
    std::vector<double> N(num_nodes);
    element.shape_values(point.xi, N);
    double R = 0;
    for (std::size_t a = 0; a < num_nodes; ++a) R += N[a] * rest_positions[a * dim];
    geometry.weight *= 2 * std::numbers::pi * R;
  }
  for (std::size_t a = 0; a < num_nodes; ++a)
    for (std::size_t k = 0; k < dim; ++k)
      for (std::size_t i = 0; i < dim; ++i)
        geometry.gradients[a * dim + i] +=
            reference[a * dim + k] * dxi_dX(static_cast<int>(k), static_cast<int>(i));
  return geometry;
}

}  // namespace resilin
