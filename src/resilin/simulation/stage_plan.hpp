#pragma once

#include "resilin/world/state.hpp"
#include "resilin/world/world.hpp"

namespace resilin {

/// One stage of a step as it is to be solved, in motion and in statics: what its potential depends on besides
/// the positions, and where its fixed unknowns go.
struct StagePlan {
  Conditions conditions;
  Stage stage;
  VectorX targets;  ///< where supports and constraints lead the fixed unknowns; the others stay [m]
};

/// A stage whose fixed unknowns go from `from` to where they are under its conditions.
StagePlan plan_stage(const World& world, const Conditions& conditions, Stage stage, VectorX from);

/// A static increment from the equilibrium `from` between two load factors: moving colliders have its whole
/// way before them.
StagePlan plan_increment(const World& world, const VectorX& from, double load, double next);
/// Its stage.
Stage stage_of_increment(const World& world, const VectorX& from, double load, double next);

/// A stage of a step in time from `start`, to which its fixed unknowns give the prescribed velocities and
/// accelerations. The unknowns of a mean take the mean motion of the step, which leads them to their places
/// at its end.
/// @param stage  as its scheme begins it
/// @param from   where the free unknowns are before
StagePlan plan_in_motion(const World& world, const State& start, double time_step, Stage stage,
                         const VectorX& from);

}  // namespace resilin
