#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "resilin/view/shown_surface.hpp"

namespace resilin {

/// How far a face reaches from the place that is meant.
struct FaceReach {
  double angle = 30;  ///< largest turn of its sides away from there [degrees]
  double radius = 0;  ///< from there, to the middle of a side, at rest [m]; 0: no limit
};

/// Face of a body at a facet: the facets around it that hang together over their edges,
/// face as it does and lie within reach, all at rest. Corners at exactly the same place count as one.
///
/// Facets are triangles, in 2D the edges of the rim.
struct FacePatch {
  std::size_t part = 0;             ///< part of the shown surface
  std::size_t touched = 0;          ///< the facet around which it lies
  std::vector<std::size_t> facets;  ///< triangles of the shown surface, in 2D of the rim; ascending
  std::vector<Index> vertices;      ///< vertices of the shown surface, ascending
};

/// The face around a touched place.
///
/// @param vertex     of the shown surface, of the triangle that is touched
/// @param place      that is touched [m]; in 2D the rim nearest to it counts
/// @param positions  where the vertices are now: 3 num_vertices() numbers
/// @throws InputError  where the vertex has no facet around it
FacePatch face_patch(const ShownSurface& surface, Index vertex, const Vector3& place,
                     std::span<const float> positions, const FaceReach& reach);

/// The nodes of the world that carry the vertices of a patch; where they stand still, so does it. Ascending.
std::vector<Index> nodes_of_patch(const ShownSurface& surface, const FacePatch& patch);

}  // namespace resilin
