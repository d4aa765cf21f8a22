#pragma once

#include <array>

#include "resilin/core/types.hpp"

namespace resilin {

/// One facet of the surface under a load: 2 nodes of an edge in 2D, 3 of a triangle in 3D, seen from outside
/// anticlockwise (in 2D with the body on the left).
struct LoadedFacet {
  std::array<Index, 3> nodes = {-1, -1, -1};
};

/// Outward normal times area [m^2] (2D: times length, on unit thickness) at positions x.
Vector3 area_vector(int dim, const LoadedFacet& facet, const VectorX& x);

/// Position of a node, the third coordinate zero in 2D [m].
Vector3 node_position(int dim, Index node, const VectorX& x);

}  // namespace resilin
