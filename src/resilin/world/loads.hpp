#pragma once

#include <memory>

#include "resilin/world/description.hpp"
#include "resilin/world/world.hpp"

namespace resilin {

/// The energy of one [[load]] on `body`, whose mesh is `mesh`.
std::shared_ptr<Energy> make_load(const LoadDescription& load, const World& world, const Body& body,
                                  const Mesh& mesh, const SelectionPart* part = nullptr);

/// The weight of all bodies [N] as dead nodal forces. In motion M g with the mass matrix that inertia has, so
/// that what falls freely keeps its shape; at rest, where no inertia acts, integral N_a rho g dV, however
/// mass is lumped. In sum both are the weight. `world.mass` must be known.
/// @param function  in place of the load factor
std::shared_ptr<Energy> make_gravity(const Vector3& gravity, const TimeFunction& function, const World& world,
                                     bool is_in_motion);

}  // namespace resilin
