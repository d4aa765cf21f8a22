#pragma once

#include <memory>
#include <vector>

#include "resilin/energy/damping.hpp"
#include "resilin/world/world.hpp"

namespace resilin {

/// Fills the damping of a world whose bodies and masses are complete.
void add_damping(const Description& description, World& world);

/// What damping adds to the energies of a stage whose velocities are v = (x - x_0) / c.
/// @param at              the shape of the bodies, about that of the stage [m]
/// @param base_positions  x_0 [m]
/// @param duration        c [s]
std::vector<std::unique_ptr<Energy>> damping_terms(const World& world, const VectorX& at,
                                                   const VectorX& base_positions, double duration);

}  // namespace resilin
