#include "resilin/simulation/stage_plan.hpp"

#include <utility>

#include "resilin/simulation/prescribed_motion.hpp"
#include "resilin/world/linear_constraints.hpp"

namespace resilin {
namespace {

/// The prescribed motion of a stage, written into the fixed unknowns of `motion`.
void prescribe(const World& world, const State& start, double time_step, const Stage& stage, Motion& motion) {
  if (!stage.is_mean) return prescribe_motion_at(world, start.time + stage.time_fraction * time_step, motion);
  Motion end = motion;
  prescribe_motion_at(world, start.time + time_step, end);
  const Motion mean = mean_of_step(start.positions, start.velocities, end, time_step);
  for (Eigen::Index i = 0; i < end.positions.size(); ++i) {
    if (world.is_fixed[static_cast<std::size_t>(i)] == 0) continue;
    motion.positions[i] = mean.positions[i];
    motion.velocities[i] = mean.velocities[i];
    motion.accelerations[i] = mean.accelerations[i];
  }
}

/// The constants of what follows other unknowns at the time of a stage, likewise its mean ones; zero
/// elsewhere.
Motion constants_of_stage(const World& world, const State& start, double time_step, const Stage& stage) {
  if (!stage.is_mean) return constants_at(world, start.time + stage.time_fraction * time_step);
  const Motion before = constants_at(world, start.time);
  return mean_of_step(before.positions, before.velocities, constants_at(world, start.time + time_step),
                      time_step);
}

}  // namespace

StagePlan plan_stage(const World& world, const Conditions& conditions, Stage stage, VectorX from) {
  StagePlan plan{.conditions = conditions, .stage = std::move(stage), .targets = std::move(from)};
  place_supports(world.dimension, world.supports, world.held_from(), conditions, plan.targets);
  set_constants(world, conditions, plan.targets);
  return plan;
}

Stage stage_of_increment(const World& world, const VectorX& from, double load, double next) {
  return static_stage(from, world.end_time * (next - load));
}

StagePlan plan_increment(const World& world, const VectorX& from, double load, double next) {
  Conditions conditions = world.at_load(next);
  conditions.delay = conditions.time - world.at_load(load).time;
  return plan_stage(world, conditions, stage_of_increment(world, from, load, next), from);
}

StagePlan plan_in_motion(const World& world, const State& start, double time_step, Stage stage,
                         const VectorX& from) {
  const VectorX zero = VectorX::Zero(from.size());
  Motion prescribed{from, zero, zero};
  prescribe(world, start, time_step, stage, prescribed);
  follow_prescribed(world, prescribed, stage);
  if (const Dependents* dependents = world.dependents()) {
    const Motion constants = constants_of_stage(world, start, time_step, stage);
    dependents->place(constants.positions - stage.duration * constants.velocities, stage.base_positions);
    dependents->place(constants.velocities - stage.duration * constants.accelerations, stage.base_velocities);
    for (const Dependents::Relation& relation : dependents->relations())
      prescribed.positions[relation.unknown] = constants.positions[relation.unknown];
  }
  return {.conditions = conditions_after(start, stage.time_fraction * time_step),
          .stage = std::move(stage),
          .targets = std::move(prescribed.positions)};
}

}  // namespace resilin
