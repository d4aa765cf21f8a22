#pragma once

#include <memory>

#include "resilin/world/description.hpp"
#include "resilin/world/world.hpp"

namespace resilin {

/// The energy of one [[load]] on `body`, whose mesh is `mesh`.
std::shared_ptr<Energy> make_load(const LoadDescription& load, const World& world, const Body& body,
                                  const Mesh& mesh);

/// The weight of all bodies [N] as dead nodal forces, integral N_a rho g dV.
std::shared_ptr<Energy> make_gravity(const Vector3& gravity, const World& world);

}  // namespace resilin
