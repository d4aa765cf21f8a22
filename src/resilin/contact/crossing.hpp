#pragma once

#include <optional>

#include "resilin/collision/surface.hpp"

namespace resilin {

/// An edge of a surface that goes through a triangle, in 2D through another edge.
struct Crossing {
  Index edge;   ///< of the surface
  Index other;  ///< triangle, in 2D edge
};

/// The first crossing of parts that meet; parts that share a vertex do not. Decided by exact predicates
/// (core/orientation.hpp), by another way than the distances and times by which contact keeps parts apart.
/// Parts that only touch, and edges within the plane of a triangle, do not cross.
/// @param places  of the vertices, dim numbers each [m]
std::optional<Crossing> first_crossing(const CollisionSurface& surface, const BodyMeetings& meetings,
                                       const VectorX& places);

/// Whether bodies whose surfaces do not cross share space: a connected piece of the one's surface is inside
/// that of the other. Told for a vertex of each piece: by the winding number of the surface around it (solid
/// angles of its triangles: Van Oosterom & Strackee 1983), in 2D by a ray.
bool is_one_inside(const CollisionSurface& surface, Index body, Index other, const VectorX& places);

}  // namespace resilin
