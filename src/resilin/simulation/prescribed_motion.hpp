#pragma once

#include "resilin/world/state.hpp"
#include "resilin/world/world.hpp"

/// How supports move their nodes while time passes.
namespace resilin {

/// The prescribed motion at a time, written into the fixed unknowns of `motion`; those without a support
/// stand still, and those that follow others do so.
void prescribe_motion_at(const World& world, double time, Motion& motion);

/// The same at the time of a stage. A stage whose unknown is a mean takes the mean motion of the step, which
/// leads the fixed unknowns to their places at its end.
void prescribe_motion(const World& world, const State& start, double time_step, const Stage& stage,
                      Motion& motion);

/// The conditions at the end of a static increment from one load factor to another: moving colliders have its
/// whole way before them.
Conditions conditions_of_increment(const World& world, double from, double to);

/// Lets the stage give the fixed unknowns their prescribed velocities and accelerations.
void follow_prescribed(const World& world, const Motion& prescribed, Stage& stage);

/// The constants of what follows other unknowns at the time of a stage, likewise its mean ones; zero
/// elsewhere. Empty where nothing follows.
Motion constants_of_stage(const World& world, const State& start, double time_step, const Stage& stage);

/// Lets the stage give what follows others the velocities and accelerations that follow.
void follow_others(const World& world, const Motion& constants, Stage& stage);

}  // namespace resilin
