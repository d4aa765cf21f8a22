#include "resilin/integrator/integrator.hpp"

#include <algorithm>

namespace resilin {
namespace {

double step_ratio(const History& start, double time_step) {
  return start.previous_time_step == 0 ? 0 : time_step / start.previous_time_step;
}

/// About the shape at the time of a stage: where damping is formed. A scheme of first order keeps that of the
/// start; others go on from the last motion that they know.
VectorX expected_shape(const StepCoefficients& scheme, std::size_t stage, int order, const History& start,
                       const std::vector<Motion>& solutions, double dt) {
  if (order == 1) return start.now.positions;
  const Motion& last = solutions.empty() ? start.now : solutions.back();
  const double passed = stage == 0 ? 0 : scheme.stages[stage - 1].time_fraction;
  return last.positions + (scheme.stages[stage].time_fraction - passed) * dt * last.velocities;
}

}  // namespace

VectorX Integrator::local_error(const History& start, const Motion& end, double time_step) const {
  const double dt = time_step;
  return end.positions - start.now.positions - dt * start.now.velocities -
         dt * dt * (start.now.accelerations / 3 + end.accelerations / 6);
}

int Integrator::num_stages() const { return static_cast<int>(coefficients(1).stages.size()); }

bool Integrator::needs_accelerations() const {
  return std::ranges::any_of(coefficients(1).stages,
                             [](const StageCoefficients& stage) { return stage.start.slope != 0; });
}

bool Integrator::looks_back() const {
  return std::ranges::any_of(coefficients(1).stages, [](const StageCoefficients& stage) {
    return stage.start.slope != 0 || stage.previous != 0 || !stage.stages.empty();
  });
}

Stage Integrator::begin_stage(int stage, const History& start, const std::vector<Motion>& solutions,
                              double time_step) const {
  const StepCoefficients scheme = coefficients(step_ratio(start, time_step));
  const auto number = static_cast<std::size_t>(stage);
  const StageCoefficients& weights = scheme.stages[number];
  Stage begun{.base_positions = start.now.positions,
              .base_velocities = start.now.velocities,
              .duration = weights.duration * time_step,
              .time_fraction = weights.time_fraction,
              .is_mean = scheme.end_start == -1 && scheme.end_stage == 2};
  // The values sum to one. Summed as differences from the start they leave a body at rest where it is, with
  // all its digits.
  const auto add_value = [&](double value, const VectorX& positions, const VectorX& velocities) {
    begun.base_positions += value * (positions - start.now.positions);
    begun.base_velocities += value * (velocities - start.now.velocities);
  };
  const auto add_slope = [&](double slope, const Motion& motion) {
    if (slope == 0) return;
    begun.base_positions += slope * time_step * motion.velocities;
    begun.base_velocities += slope * time_step * motion.accelerations;
  };
  add_slope(weights.start.slope, start.now);
  for (std::size_t k = 0; k < weights.stages.size(); ++k) {
    add_value(weights.stages[k].value, solutions[k].positions, solutions[k].velocities);
    add_slope(weights.stages[k].slope, solutions[k]);
  }
  if (weights.previous != 0) add_value(weights.previous, start.previous_positions, start.previous_velocities);
  const double begin = stage == 0 ? 0 : scheme.stages[number - 1].time_fraction;
  const double end = begun.is_mean ? 1 : weights.time_fraction;
  const double slope = begun.end_slope();
  begun.contact_weight = (end - begin) / (slope * slope * weights.duration);
  begun.elapsed = weights.time_fraction * time_step;
  begun.shape = expected_shape(scheme, number, order(), start, solutions, time_step);
  return begun;
}

Motion Integrator::finish(const History& start, std::vector<Motion> solutions, double time_step) const {
  const StepCoefficients scheme = coefficients(step_ratio(start, time_step));
  Motion end = std::move(solutions.back());
  if (scheme.end_start == 0 && scheme.end_stage == 1) return end;
  end.positions = scheme.end_stage * end.positions + scheme.end_start * start.now.positions;
  end.velocities = scheme.end_stage * end.velocities + scheme.end_start * start.now.velocities;
  return end;
}

void Integrator::add_slopes_of_stage(int stage, const Stage& slopes, double time_step, History& start,
                                     std::vector<Motion>& solutions) const {
  const StepCoefficients scheme = coefficients(step_ratio(start, time_step));
  const auto number = static_cast<std::size_t>(stage);
  const StageCoefficients& weights = scheme.stages[number];
  const auto add_value = [&](double value, VectorX& positions, VectorX& velocities) {
    positions += value * slopes.base_positions;
    velocities += value * slopes.base_velocities;
  };
  const auto add_slope = [&](double slope, Motion& motion) {
    if (slope == 0) return;
    motion.velocities += slope * time_step * slopes.base_positions;
    motion.accelerations += slope * time_step * slopes.base_velocities;
  };
  double of_start = 1;
  for (std::size_t k = 0; k < weights.stages.size(); ++k) {
    add_value(weights.stages[k].value, solutions[k].positions, solutions[k].velocities);
    add_slope(weights.stages[k].slope, solutions[k]);
    of_start -= weights.stages[k].value;
  }
  if (weights.previous != 0) {
    add_value(weights.previous, start.previous_positions, start.previous_velocities);
    of_start -= weights.previous;
  }
  add_value(of_start, start.now.positions, start.now.velocities);
  add_slope(weights.start.slope, start.now);
  // As `expected_shape` has it.
  Motion& last = order() == 1 || stage == 0 ? start.now : solutions[number - 1];
  last.positions += slopes.shape;
  if (order() == 1) return;
  const double passed = stage == 0 ? 0 : scheme.stages[number - 1].time_fraction;
  last.velocities += (weights.time_fraction - passed) * time_step * slopes.shape;
}

void Integrator::add_slopes_of_end(const Motion& slopes, double time_step, History& start,
                                   std::vector<Motion>& solutions) const {
  const StepCoefficients scheme = coefficients(step_ratio(start, time_step));
  Motion& last = solutions.back();
  last.positions += scheme.end_stage * slopes.positions;
  last.velocities += scheme.end_stage * slopes.velocities;
  last.accelerations += slopes.accelerations;
  start.now.positions += scheme.end_start * slopes.positions;
  start.now.velocities += scheme.end_start * slopes.velocities;
}

}  // namespace resilin
