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

}  // namespace resilin
