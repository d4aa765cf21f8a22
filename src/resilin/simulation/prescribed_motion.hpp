#pragma once

#include "resilin/world/state.hpp"
#include "resilin/world/world.hpp"

/// How supports move their nodes while time passes.
namespace resilin {

/// The prescribed motion at a time, written into the fixed unknowns of `motion`; those without a support
/// stand still, and those that follow others do so.
void prescribe_motion_at(const World& world, double time, Motion& motion);

/// The constants of what follows other unknowns at a time; zero elsewhere.
Motion constants_at(const World& world, double time);

/// The mean motion of a step, from its start to its end.
Motion mean_of_step(const VectorX& positions, const VectorX& velocities, const Motion& end, double time_step);

/// Lets the stage give the fixed unknowns their prescribed velocities and accelerations.
void follow_prescribed(const World& world, const Motion& prescribed, Stage& stage);

}  // namespace resilin
