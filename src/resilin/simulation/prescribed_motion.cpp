#include "resilin/simulation/prescribed_motion.hpp"

#include "resilin/world/linear_constraints.hpp"

namespace resilin {

Motion constants_at(const World& world, double time) {
  const VectorX zero = VectorX::Zero(world.rest_positions.size());
  Motion constants{zero, zero, zero};
  set_constants(world, time, constants);
  return constants;
}

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

void follow_prescribed(const World& world, const Motion& prescribed, Stage& stage) {
  for (Eigen::Index i = 0; i < prescribed.positions.size(); ++i) {
    if (world.is_fixed[static_cast<std::size_t>(i)] == 0) continue;
    stage.base_positions[i] = prescribed.positions[i] - stage.duration * prescribed.velocities[i];
    stage.base_velocities[i] = prescribed.velocities[i] - stage.duration * prescribed.accelerations[i];
  }
}

Motion mean_of_step(const VectorX& positions, const VectorX& velocities, const Motion& end,
                    double time_step) {
  return {.positions = 0.5 * (positions + end.positions),
          .velocities = (end.positions - positions) / time_step,
          .accelerations = (end.velocities - velocities) / time_step};
}

}  // namespace resilin
