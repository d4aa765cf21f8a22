#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "resilin/core/types.hpp"

namespace resilin {

/// A point of the reference cell at which energies are sampled.
struct QuadraturePoint {
  Vector3 xi;     ///< reference coordinates; the third is zero in 2D
  double weight;  ///< the weights sum to the size of the reference cell
};

/// Isoparametric element at run time. Shape functions are functions of the reference coordinates xi.
struct ElementInfo {
  std::string_view name;  ///< as in a scene file: "P1"
  int dim;
  int num_nodes;
  std::string_view quadrature;  ///< in words: "1-point"
  std::span<const QuadraturePoint> points;

  /// N_a(xi), one for each node.
  void (*shape_values)(const Vector3& xi, std::span<double> values);
  /// dN_a/dxi_k at [a * dim + k].
  void (*shape_gradients)(const Vector3& xi, std::span<double> gradients);
};

/// Quadrature weight times size, and the gradients of the shape functions on the rest shape, at one point.
struct PointGeometry {
  double weight;                  ///< [m^3], in 2D [m^2] on unit thickness; not positive for an inverted cell
  std::vector<double> gradients;  ///< dN_a/dX_k at [a * dim + k] [1/m]
};

/// @param rest_positions  dim numbers for each node of the cell, in the element's node order [m]
PointGeometry point_geometry(const ElementInfo& element, const QuadraturePoint& point,
                             std::span<const double> rest_positions);

}  // namespace resilin
