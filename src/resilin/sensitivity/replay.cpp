#include "resilin/sensitivity/replay.hpp"

#include <algorithm>

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

Potential potential_of(const World& world, const StageReplay& stage) {
  Potential potential = Potential::in_stage(world, VectorX(), stage.conditions, stage.stage);
  potential.prepare(stage.motion.positions, VectorX::Zero(stage.motion.positions.size()));
  potential.form_lag(stage.motion.positions);
  return potential;
}

// The end of the step is end_start times its start and end_stage times its last stage, whatever its length.
std::vector<VectorX> places_of_stages(const Integrator& scheme, const History& start, const State& end,
                                      std::vector<VectorX> earlier) {
  const StepCoefficients coefficients = scheme.coefficients(1);
  earlier.emplace_back((end.positions - coefficients.end_start * start.now.positions) /
                       coefficients.end_stage);
  return earlier;
}

namespace {

/// As a run takes them apart (TimeStepper). @return StageReplay::by_impulses
VectorX impulses_apart(const World& world, const Integrator& scheme, const StageReplay& stage) {
  if (!scheme.looks_back() && stage.stage.count_of_impulse() == 1) return {};
  if (std::ranges::none_of(world.terms,
                           [](const auto& term) { return acts_as_impulse(term->properties().category); }))
    return {};
  const VectorX impulses = potential_of(world, stage).impulses(stage.motion.positions);
  return impulses.isZero(0) ? VectorX() : accelerations_by(world, -impulses);
}

/// Follows the state at the start of a step after an impulse in one of its stages, which ended in `end`.
void follow_impulse(const Integrator& scheme, const StageReplay& stage, const Motion& end, double time_step,
                    VectorX& positions, VectorX& velocities) {
  if (!scheme.looks_back() || stage.by_impulses.size() == 0) return;
  follow_jump(stage.stage.jump_by(stage.by_impulses), stage.stage.time_from_start(time_step), end, positions,
              velocities);
}

}  // namespace

StepReplay replay_step(const World& world, const Integrator& scheme, const History& start, double time,
                       double time_step, std::vector<VectorX> places, std::vector<VectorX> by_impulses) {
  StepReplay step{.time = time, .time_step = time_step, .start = start};
  const State state = state_of(start, time);
  if (scheme.needs_accelerations() && is_event(world, time)) {
    step.renews_accelerations = true;
    step.start.now.accelerations = accelerations_from(world, state, time_step);
  }
  History seen = step.start;
  std::vector<Motion> solutions;
  for (std::size_t i = 0; i < places.size(); ++i) {
    Stage stage = scheme.begin_stage(static_cast<int>(i), seen, solutions, time_step);
    const VectorX zero = VectorX::Zero(places[i].size());
    Motion prescribed{places[i], zero, zero};
    prescribe_motion(world, state, time_step, stage, prescribed);
    follow_prescribed(world, prescribed, stage);
    Motion motion = stage.motion(std::move(prescribed.positions));
    const Conditions conditions{.time = time + stage.time_fraction * time_step, .load = 1};
    step.stages.push_back({std::move(stage), conditions, std::move(motion)});
    StageReplay& made = step.stages.back();
    made.by_impulses = by_impulses.empty() ? impulses_apart(world, scheme, made) : std::move(by_impulses[i]);
    if (scheme.looks_back() && made.by_impulses.size() > 0) made.motion.accelerations -= made.by_impulses;
    follow_impulse(scheme, made, made.motion, time_step, seen.now.positions, seen.now.velocities);
    solutions.push_back(made.motion);
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
  follow_impulse(scheme, step.stages.back(), next.now, step.time_step, next.previous_positions,
                 next.previous_velocities);
  prescribe_motion_at(world, step.time + step.time_step, next.now);
  return next;
}

}  // namespace resilin
