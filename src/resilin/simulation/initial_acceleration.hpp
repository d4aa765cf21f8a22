#pragma once

#include "resilin/world/state.hpp"
#include "resilin/world/world.hpp"

namespace resilin {

/// Accelerations [m/s^2] that forces [N] give to bodies: M a = f over the free unknowns, zero at the fixed
/// ones. A consistent mass matrix is solved with.
VectorX accelerations_by(const World& world, const VectorX& forces);

/// Accelerations [m/s^2] at the present state: M a = -dE/dx over the free unknowns, with those of the fixed
/// ones, `prescribed`, given. Contact has no part in them: its forces act as impulses.
VectorX accelerations_at(const World& world, const State& state, const VectorX& prescribed);

}  // namespace resilin
