#pragma once

#include <array>
#include <span>
#include <vector>

#include "resilin/core/types.hpp"
#include "resilin/mesh/mesh.hpp"

namespace resilin {

/// Quadrature point of a facet: lines and second-order lines in 2D; triangles, second-order triangles and
/// quadrilaterals in 3D. Nodes in the order of MSH.
struct FacetPoint {
  double weight;
  std::array<double, max_facet_nodes> values;      ///< N_a
  std::array<double, 2 * max_facet_nodes> slopes;  ///< dN_a/dxi_k at [2 a + k]
};

/// Points that integrate N_a times the area vector exactly (both are polynomials), so also a load that
/// follows the surface.
const std::vector<FacetPoint>& facet_points(CellKind kind);

/// Outward normal times area per reference area [m^2] (2D: times length, on unit thickness) of the facet with
/// these nodes at positions x: dx/dxi_0 x dx/dxi_1. A facet is seen from outside anticlockwise (in 2D with
/// the body on the left).
Vector3 area_vector(int dim, const FacetPoint& point, std::span<const Index> nodes, const VectorX& x);

/// Outward normal times area of the whole facet.
Vector3 area_vector(int dim, CellKind kind, std::span<const Index> nodes, const VectorX& x);

/// Position of a node, the third coordinate zero in 2D [m].
Vector3 node_position(int dim, Index node, const VectorX& x);

}  // namespace resilin
