#include "resilin/simulation/prescribed_motion.hpp"

namespace resilin {

void prescribe_motion_at(const World& world, double time, Motion& motion) {
  for (Eigen::Index i = 0; i < motion.positions.size(); ++i) {
    if (world.is_fixed[static_cast<std::size_t>(i)] == 0) continue;
    motion.velocities[i] = 0;
    motion.accelerations[i] = 0;
  }
  place_supports(world.dimension, world.supports, world.rest_positions, time, motion);
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

void follow_prescribed(const World& world, const Motion& prescribed, Stage& stage) {
  for (Eigen::Index i = 0; i < prescribed.positions.size(); ++i) {
    if (world.is_fixed[static_cast<std::size_t>(i)] == 0) continue;
    stage.base_positions[i] = prescribed.positions[i] - stage.duration * prescribed.velocities[i];
    stage.base_velocities[i] = prescribed.velocities[i] - stage.duration * prescribed.accelerations[i];
  }
}

}  // namespace resilin
