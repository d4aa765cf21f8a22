#include "resilin/simulation/prescribed_motion.hpp"

#include "resilin/world/linear_constraints.hpp"

namespace resilin {
namespace {

Motion constants_at(const World& world, double time) {
  const VectorX zero = VectorX::Zero(world.rest_positions.size());
  Motion constants{zero, zero, zero};
  set_constants(world, time, constants);
  return constants;
}

}  // namespace

void prescribe_motion_at(const World& world, double time, Motion& motion) {
  for (Eigen::Index i = 0; i < motion.positions.size(); ++i) {
    if (world.is_fixed[static_cast<std::size_t>(i)] == 0) continue;
    motion.velocities[i] = 0;
    motion.accelerations[i] = 0;
  }
  place_supports(world.dimension, world.supports, world.held_from(), time, motion);
  const Dependents* dependents = world.dependents();
  if (dependents == nullptr) return;
  const Motion constants = constants_at(world, time);
  dependents->place(constants.positions, motion.positions);
  dependents->place(constants.velocities, motion.velocities);
  dependents->place(constants.accelerations, motion.accelerations);
}

void prescribe_motion(const World& world, const State& start, double time_step, const Stage& stage,
                      Motion& motion) {
  if (!stage.is_mean) return prescribe_motion_at(world, start.time + stage.time_fraction * time_step, motion);
  Motion end = motion;
  prescribe_motion_at(world, start.time + time_step, end);
  for (Eigen::Index i = 0; i < end.positions.size(); ++i) {
    if (world.is_fixed[static_cast<std::size_t>(i)] == 0) continue;
    motion.positions[i] = 0.5 * (start.positions[i] + end.positions[i]);
    motion.velocities[i] = (end.positions[i] - start.positions[i]) / time_step;
    motion.accelerations[i] = (end.velocities[i] - start.velocities[i]) / time_step;
  }
}

Conditions conditions_of_increment(const World& world, double from, double to) {
  Conditions conditions = world.at_load(to);
  conditions.delay = conditions.time - world.at_load(from).time;
  return conditions;
}

void follow_prescribed(const World& world, const Motion& prescribed, Stage& stage) {
  for (Eigen::Index i = 0; i < prescribed.positions.size(); ++i) {
    if (world.is_fixed[static_cast<std::size_t>(i)] == 0) continue;
    stage.base_positions[i] = prescribed.positions[i] - stage.duration * prescribed.velocities[i];
    stage.base_velocities[i] = prescribed.velocities[i] - stage.duration * prescribed.accelerations[i];
  }
}

Motion constants_of_stage(const World& world, const State& start, double time_step, const Stage& stage) {
  if (world.dependents() == nullptr) return {};
  if (!stage.is_mean) return constants_at(world, start.time + stage.time_fraction * time_step);
  const Motion before = constants_at(world, start.time), after = constants_at(world, start.time + time_step);
  return {.positions = 0.5 * (before.positions + after.positions),
          .velocities = (after.positions - before.positions) / time_step,
          .accelerations = (after.velocities - before.velocities) / time_step};
}

void follow_others(const World& world, const Motion& constants, Stage& stage) {
  const Dependents* dependents = world.dependents();
  if (dependents == nullptr) return;
  dependents->place(constants.positions - stage.duration * constants.velocities, stage.base_positions);
  dependents->place(constants.velocities - stage.duration * constants.accelerations, stage.base_velocities);
}

}  // namespace resilin
