#pragma once

#include <vector>

#include "resilin/mesh/facet.hpp"

namespace resilin {

/// How much area a length in the plane stands for: in 3D none of its own.
struct Depth {
  double thickness = 1;    ///< [m]
  bool is_turned = false;  ///< about the axis r = 0 (docs/theory/axisymmetry.md), by 2 pi r instead
  double axis = 0;         ///< radius up to which places lie on the axis [m]

  /// At a place at rest [m].
  double at(double r) const;
  bool is_on_axis(double r) const { return is_turned && r <= axis; }
};

/// Points that also integrate N_a^2 times the area vector times the radius exactly where `depth` is turned.
const std::vector<FacetPoint>& facet_points(CellKind kind, const Depth& depth);

/// Depth at a point of a facet at rest.
double depth_at(int dim, const FacetPoint& point, std::span<const Index> nodes, const VectorX& rest_positions,
                const Depth& depth);

}  // namespace resilin
