#pragma once

#include <span>
#include <vector>

#include "resilin/collision/surface.hpp"
#include "resilin/mesh/depth.hpp"

namespace resilin {

/// Share of a facet's area for one of its vertices.
struct FacetShare {
  Vector3 normal;  ///< normal of length 1
  double area;     ///< [m^2]
};

/// The most that faces in one direction see of the shares of a vertex. Within a plane it is all of them, on
/// the ridge of a box what belongs to one of its faces: the other carries nothing of what presses this one.
double facing_area(std::span<const FacetShare> shares);

/// Facing area of every vertex: of a third of each triangle beside it, in 2D of half of each edge, in
/// axisymmetric solids of the integral of N_a 2 pi r along each edge.
/// @param places  of the vertices, dim numbers each [m]
/// @return        [m^2]
std::vector<double> facing_areas(const CollisionSurface& parts, const VectorX& places,
                                 const Depth& depth = {});

}  // namespace resilin
