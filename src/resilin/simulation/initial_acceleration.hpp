#pragma once

#include "resilin/world/state.hpp"
#include "resilin/world/world.hpp"

namespace resilin {

/// Accelerations [m/s^2] at the present state: M a = -dE/dx over the free unknowns, with those of the fixed
/// ones, `prescribed`, given. A consistent mass matrix is solved with.
VectorX accelerations_at(const World& world, const State& state, const VectorX& prescribed);

}  // namespace resilin
