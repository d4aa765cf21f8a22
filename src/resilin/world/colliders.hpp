#pragma once

#include <memory>
#include <vector>

#include "resilin/contact/collider_barrier.hpp"
#include "resilin/contact/contact_surface.hpp"
#include "resilin/world/world.hpp"

namespace resilin {

/// Per node: whether supports hold it in all directions. Their support says where they are, and no collider
/// pushes them.
std::vector<std::uint8_t> held_nodes(const World& world);

/// The surface nodes of all bodies with their barrier stiffness times area, ascending. Held
/// ones are left out.
/// @param stiffness  of the barrier [Pa]; none: a tenth of each body's Young's modulus at small strain
std::vector<ContactNode> contact_nodes(const World& world, std::optional<double> stiffness = {});

/// The surfaces of all bodies, likewise.
std::vector<ContactBody> contact_bodies(const World& world, std::optional<double> stiffness);

/// The largest extent of the smallest body [m].
double smallest_extent(const World& world);

/// The least extent of a body along the axes [m]; no body is thicker than that.
double thinnest_extent(const World& world, const Body& body);

/// [m]: 0.005 of the largest extent of the smallest body, and at most a tenth of the thickness of any.
/// Smaller gaps look better and cost Newton iterations: a barrier is felt only so far away, and a step ends
/// where a node has lost nine tenths of its distance.
double default_activation_distance(const World& world);

/// @param end_time  when a displacement without a function of time is reached [s]
ColliderMotion motion_of(const ColliderDescription& description, double end_time);

/// Adds it to the world, which is complete but for colliders and what moves; throws InputError for a collider
/// that cannot be, and for a body that starts through it.
void add_collider(const ColliderDescription& description, World& world);

/// Throws InputError at `place` naming the vertex that is deepest inside the collider, if one is inside.
void check_is_outside(const ColliderBarrier& collider, const World& world, const VectorX& positions,
                      const Conditions& conditions, const std::string& place);

}  // namespace resilin
