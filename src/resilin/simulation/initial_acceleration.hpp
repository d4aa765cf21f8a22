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

/// Whether a load or a prescribed motion is not smooth at this time: there a step begins with the
/// accelerations of what follows.
bool is_event(const World& world, double time);

/// The accelerations that the loads and the prescribed motions give from now on, where a step begins.
VectorX accelerations_from(const World& world, State state, double time_step);

/// When "from now on" is: later by what times are told apart by [s].
double time_after(double time, double time_step);

// Terms that these accelerations balance: the gradient of all terms but inertia and those that act as
// impulses, ...
Terms smooth_terms(const World& world);
/// ... in a stage that has these velocities, v = (x - x_0) / c for any c.
Stage stage_at_once(const VectorX& positions, const VectorX& velocities);

}  // namespace resilin
