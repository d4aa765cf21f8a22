#pragma once

#include <memory>

#include "resilin/contact/catalog.hpp"
#include "resilin/world/world.hpp"

namespace resilin {

/// A collider of facets. Throws InputError for one that cannot be, and for bodies that start through it, on
/// it or, where it is closed, inside.
std::shared_ptr<const ObstacleContact> make_mesh_collider(const ColliderDescription& description,
                                                          const ShapeKind& kind, double activation_distance,
                                                          const World& world);

/// Throws InputError for bodies that start around a surface or with it through a side of theirs, between
/// their vertices, of which it holds none.
void check_is_beside(ColliderMesh mesh, const ColliderDescription& description, double activation_distance,
                     const World& world);

}  // namespace resilin
