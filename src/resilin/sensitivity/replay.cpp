#include "resilin/sensitivity/replay.hpp"

#include <stdexcept>

#include "resilin/simulation/initial_acceleration.hpp"
#include "resilin/simulation/prescribed_motion.hpp"

namespace resilin {
namespace {

State state_of(const History& start, double time) {
  State state;
  state.time = time;
  state.load = 1;
  state.positions = start.now.positions;
  state.velocities = start.now.velocities;
  state.accelerations = start.now.accelerations;
  return state;
}

}  // namespace

std::vector<VectorX> places_of_stages(const Integrator& scheme, const History& start, double time_step,
                                      const State& end) {
  const double ratio = start.previous_time_step == 0 ? 0 : time_step / start.previous_time_step;
  const StepCoefficients coefficients = scheme.coefficients(ratio);
  // The end of the step is end_start times its start and end_stage times its last stage.
  const auto last_of = [&](const VectorX& at_end, const VectorX& at_start) {
    return VectorX((at_end - coefficients.end_start * at_start) / coefficients.end_stage);
  };
  std::vector<VectorX> places = {last_of(end.positions, start.now.positions)};
  if (coefficients.stages.size() == 1) return places;
  const StageCoefficients& last = coefficients.stages.back();
  if (coefficients.stages.size() > 2 || last.start.slope != 0 || last.previous != 0 ||
      last.stages.front().slope != 0)
    throw std::logic_error("the places of the stages of " + std::string(scheme.name()) + " are not known");
  // x - c v = x_n + value (x_1 - x_n)
  const VectorX base =
      places.front() - last.duration * time_step * last_of(end.velocities, start.now.velocities);
  places.insert(places.begin(),
                start.now.positions + (base - start.now.positions) / last.stages.front().value);
  return places;
}

StepReplay replay_step(const World& world, const Integrator& scheme, const History& start, double time,
                       double time_step, std::vector<VectorX> places) {
  StepReplay step{.time = time, .time_step = time_step, .start = start};
  const State state = state_of(start, time);
  if (scheme.needs_accelerations() && is_event(world, time)) {
    step.renews_accelerations = true;
    step.start.now.accelerations = accelerations_from(world, state, time_step);
  }
  std::vector<Motion> solutions;
  for (std::size_t i = 0; i < places.size(); ++i) {
    Stage stage = scheme.begin_stage(static_cast<int>(i), step.start, solutions, time_step);
    const VectorX zero = VectorX::Zero(places[i].size());
    Motion prescribed{places[i], zero, zero};
    prescribe_motion(world, state, time_step, stage, prescribed);
    follow_prescribed(world, prescribed, stage);
    solutions.push_back(stage.motion(std::move(prescribed.positions)));
    const Conditions conditions{.time = time + stage.time_fraction * time_step, .load = 1};
    step.stages.push_back({std::move(stage), conditions, solutions.back()});
  }
  return step;
}

History history_after(const World& world, const Integrator& scheme, const StepReplay& step) {
  std::vector<Motion> solutions;
  for (const StageReplay& stage : step.stages) solutions.push_back(stage.motion);
  History next{.now = scheme.finish(step.start, std::move(solutions), step.time_step),
               .previous_positions = step.start.now.positions,
               .previous_velocities = step.start.now.velocities,
               .previous_time_step = step.time_step};
  prescribe_motion_at(world, step.time + step.time_step, next.now);
  return next;
}

}  // namespace resilin
