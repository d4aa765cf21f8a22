#pragma once

#include <memory>
#include <optional>
#include <string>

#include "resilin/contact/collider_barrier.hpp"
#include "resilin/world/world.hpp"

namespace resilin {

/// @param end_time  when a displacement without a function of time is reached [s]
ColliderMotion motion_of(const ColliderDescription& description, double end_time);

/// The facets of all bodies that a ball meets besides their nodes: null where they are small beside it.
/// @param least_radius  that the ball ever has [m]
/// @param stiffness     as for contact_points
/// @param center        at the start; its distance from the axis counts in axisymmetric scenes [m]
std::shared_ptr<const BallFacets> ball_facets(const World& world, double least_radius,
                                              std::optional<double> stiffness, double activation_distance,
                                              const Vector3& center = Vector3::Zero());

/// Adds it to the world, which is complete but for colliders and what moves; throws InputError for a collider
/// that cannot be, and for a body that starts through it.
void add_collider(const ColliderDescription& description, World& world, const ContactPart* part = nullptr);

/// Throws InputError at `place` naming the vertex that is deepest inside the collider, if one is inside.
void check_is_outside(const ColliderBarrier& collider, const World& world, const VectorX& positions,
                      const Conditions& conditions, const std::string& place);

}  // namespace resilin
