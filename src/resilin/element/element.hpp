#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "resilin/element/quadrature.hpp"

namespace resilin {

/// Isoparametric element at run time. Shape functions are functions of the reference coordinates xi. Nodes
/// are in the order of MSH (Gmsh): corners first, then the middles of edges.
struct ElementInfo {
  std::string_view name;  ///< as in a scene file: "P2"
  std::string_view text;  ///< description for the documentation
  CellShape shape;
  int dim;
  int num_nodes;
  int degree;            ///< degree of its shape functions
  bool has_mean_volume;  ///< mixed element: constant pressure per cell, from the mean volume ratio
  std::string_view default_quadrature;
  std::span<const Vector3> nodes;  ///< reference coordinates of the nodes

  /// N_a(xi), one for each node.
  void (*shape_values)(const Vector3& xi, std::span<double> values);
  /// dN_a/dxi_k at [a * dim + k].
  void (*shape_gradients)(const Vector3& xi, std::span<double> gradients);

  int num_corners() const;
  /// Degree of det dX/dxi: of all coordinates together on simplices, in each coordinate on squares and cubes.
  int jacobian_degree() const;
  /// Quadrature rules that integrate a linear elastic energy well enough to hold all modes of the element.
  std::vector<std::string> quadrature_names() const;
  /// The rule of this name, the default one for "". Throws InputError(place, ...) that lists the others.
  const QuadratureRule& quadrature(std::string_view rule_name, const std::string& place) const;
};

/// An element by name, with one of its quadrature rules; an empty rule is the element's default.
struct ElementChoice {
  std::string_view element;
  std::string_view quadrature = {};

  ElementChoice(std::string_view name, std::string_view rule = {}) : element(name), quadrature(rule) {}
  ElementChoice(const char* name) : element(name) {}
  ElementChoice(const std::string& name) : element(name) {}
};

/// Quadrature weight times size, and the gradients of the shape functions on the rest shape, at one point.
struct PointGeometry {
  double weight;                  ///< [m^3], in 2D [m^2] on unit thickness; not positive for an inverted cell
  std::vector<double> gradients;  ///< dN_a/dX_k at [a * dim + k] [1/m]
  Matrix<3> dxi_dX;               ///< [1/m]; in 2D with the third direction of unit length
};

/// @param rest_positions  dim numbers for each node of the cell, in the element's node order [m]
PointGeometry point_geometry(const ElementInfo& element, const QuadraturePoint& point,
                             std::span<const double> rest_positions);

}  // namespace resilin
