#include "resilin/sensitivity/replay.hpp"

#include <algorithm>
#include <utility>

#include "resilin/simulation/initial_acceleration.hpp"
#include "resilin/simulation/prescribed_motion.hpp"
#include "resilin/simulation/stage_plan.hpp"
#include "resilin/world/linear_constraints.hpp"

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

}  // namespace

StepReplay replay_step(const World& world, const Integrator& scheme, const History& start, double time,
                       double time_step, std::vector<VectorX> places, std::vector<VectorX> by_impulses) {
  const State state = state_of(start, time);
  const bool renews_accelerations = scheme.needs_accelerations() && is_event(world, time);
  History from = start;
  if (renews_accelerations) from.now.accelerations = accelerations_from(world, state, time_step);
  StepReplay step{.time = time,
                  .time_step = time_step,
                  .renews_accelerations = renews_accelerations,
                  .sequence = StageSequence(scheme, std::move(from), time_step)};
  for (std::size_t i = 0; i < places.size(); ++i) {
    StagePlan plan = plan_in_motion(world, state, time_step, step.sequence.begin(), places[i]);
    if (world.constraints) world.dependents()->place(VectorX(plan.targets), plan.targets);
    Motion motion = plan.stage.motion(std::move(plan.targets));
    step.stages.push_back({std::move(plan.stage), plan.conditions, std::move(motion)});
    StageReplay& made = step.stages.back();
    made.by_impulses = by_impulses.empty() ? impulses_apart(world, scheme, made) : std::move(by_impulses[i]);
    step.sequence.end(made.stage, made.motion, scheme.looks_back() ? made.by_impulses : VectorX());
    made.motion = step.sequence.solutions().back();
  }
  return step;
}

History history_after(const World& world, const StepReplay& step) {
  StageSequence sequence = step.sequence;
  Motion end = sequence.finish();
  prescribe_motion_at(world, step.time + step.time_step, end);
  return sequence.after(std::move(end));
}

}  // namespace resilin
