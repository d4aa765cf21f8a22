#pragma once

#include <memory>
#include <vector>

#include "resilin/contact/collider_barrier.hpp"
#include "resilin/world/world.hpp"

namespace resilin {

/// The surface nodes of all bodies with their barrier stiffness times area, ascending. Nodes that supports
/// hold in all directions are left out: their support says where they are.
/// @param stiffness  of the barrier [Pa]; none: a tenth of each body's Young's modulus at small strain
std::vector<ContactNode> contact_nodes(const World& world, std::optional<double> stiffness = {});

/// The stiffness of a body's barrier [Pa]: as asked, or a tenth of its Young's modulus at small strain.
double barrier_stiffness(const Body& body, std::optional<double> asked);

/// [m]: 0.005 of the largest extent of the smallest body. Smaller gaps look better and cost Newton
/// iterations: a barrier is felt only so far away, and a step ends where a node has lost nine tenths of its
/// distance.
double default_activation_distance(const World& world);

/// Throws InputError for a collider that cannot be, and for a body that starts through it.
std::shared_ptr<const ColliderBarrier> make_collider(const ColliderDescription& description,
                                                     const World& world);

/// Throws InputError at `place` naming the vertex that is deepest inside the collider, if one is inside.
void check_is_outside(const ColliderBarrier& collider, const World& world, const VectorX& positions,
                      const Conditions& conditions, const std::string& place);

}  // namespace resilin
