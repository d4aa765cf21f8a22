#pragma once

#include <array>
#include <optional>

#include "resilin/collision/surface.hpp"

namespace resilin {

/// An edge of a surface that goes through a triangle, in 2D through another edge.
struct Crossing {
  Index edge;   ///< edge of the surface
  Index other;  ///< triangle, in 2D edge
};
/// The first vertex of the edge, near which it is, and that of the other part.
std::array<Index, 2> vertices_of(const Crossing& crossing, const CollisionSurface& surface);

/// The first crossing of parts that meet; parts that share a vertex do not. Decided by exact predicates
/// (core/orientation.hpp), by another way than the distances and times by which contact keeps parts apart.
/// Parts that only touch, and edges within the plane of a triangle, do not cross.
/// @param places  of the vertices, dim numbers each [m]
std::optional<Crossing> first_crossing(const CollisionSurface& surface, const BodyMeetings& meetings,
                                       const VectorX& places);

/// Whether a point is inside the closed surface of a body: by the winding number of the surface around it
/// (solid angles of its triangles: Van Oosterom & Strackee 1983), in 2D by a ray.
bool is_inside(const CollisionSurface& surface, Index body, const Vector3& point, const VectorX& places);

/// Whether a connected piece of a body's surface, which does not cross the closed one of another, is inside
/// of that. Told for a vertex of each piece.
bool has_piece_inside(const CollisionSurface& surface, Index body, Index other, const VectorX& places);

/// The place of that vertex, if there is one [m].
std::optional<Vector3> place_of_piece_inside(const CollisionSurface& surface, Index body, Index other,
                                             const VectorX& places);

}  // namespace resilin
