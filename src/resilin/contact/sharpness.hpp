#pragma once

#include <span>
#include <vector>

#include "resilin/collision/surface.hpp"
#include "resilin/mesh/depth.hpp"

namespace resilin {

/// How far the parts of a rigid surface stick out: for each the share of all directions in which it is ahead
/// of what is around it, that of its normal cone. Zero within a plane and for the vertices of a straight
/// ridge, a quarter for the edges of a box and an eighth for its corners, one for what is by itself.
///
/// Something flat that comes near meets the parts of zero sharpness no earlier than those around them, so
/// that these alone need keep it off; and cut into smaller parts, a surface has the same in sum.
/// Edges are taken as ridges from either side, and vertices by the angles around them (Gauss's curvature).
struct Sharpness {
  std::vector<double> edges;   ///< edges of the surface, in 2D none
  std::vector<double> points;  ///< points of its vertices
};

/// @param triangle_edges  three for each triangle; -1 where it repeats a vertex
/// @param places          of the vertices, dim numbers each [m]
Sharpness sharpness_of(const CollisionSurface& parts, std::span<const Index> triangle_edges,
                       const VectorX& places);

/// In axisymmetric solids a line that ends on the axis goes on on the other side: gives its end the sharpness
/// of both.
void turn_tips(const CollisionSurface& parts, const VectorX& places, const Depth& depth,
               Sharpness& sharpness);

}  // namespace resilin
