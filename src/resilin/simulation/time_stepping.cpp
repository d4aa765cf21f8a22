#include "resilin/simulation/time_stepping.hpp"

#include <cmath>

#include "resilin/integrator/backward_euler.hpp"
#include "resilin/simulation/initial_acceleration.hpp"
#include "resilin/simulation/potential.hpp"

namespace resilin {
namespace {

History history_of(const State& state) {
  return {.now = {state.positions, state.velocities, state.accelerations},
          .previous_positions = state.previous_positions,
          .previous_velocities = state.previous_velocities,
          .previous_time_step = state.previous_time_step};
}

/// The prescribed motion at a time; fixed unknowns without a support stand still.
void prescribe_motion_at(const World& world, double time, Motion& motion) {
  for (Eigen::Index i = 0; i < motion.positions.size(); ++i) {
    if (world.is_fixed[static_cast<std::size_t>(i)] == 0) continue;
    motion.velocities[i] = 0;
    motion.accelerations[i] = 0;
  }
  place_supports(world.dimension, world.supports, world.rest_positions, time, motion);
}

/// The prescribed motion at the time of a stage, written into the fixed unknowns of `motion`. A stage whose
/// unknown is a mean takes the mean motion of the step, which leads the fixed unknowns to their places at its
/// end.
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

/// Lets the stage give the fixed unknowns their prescribed velocities and accelerations.
void follow_prescribed(const World& world, const Motion& prescribed, Stage& stage) {
  for (Eigen::Index i = 0; i < prescribed.positions.size(); ++i) {
    if (world.is_fixed[static_cast<std::size_t>(i)] == 0) continue;
    stage.base_positions[i] = prescribed.positions[i] - stage.duration * prescribed.velocities[i];
    stage.base_velocities[i] = prescribed.velocities[i] - stage.duration * prescribed.accelerations[i];
  }
}

bool is_in_domain(const World& world, const VectorX& x, const Conditions& conditions) {
  double sum = 0;
  for (const auto& energy : world.elastic) sum += energy->value(x, conditions);
  return std::isfinite(sum);
}

void move_to(State& state, Motion end, double time_step) {
  state.previous_positions = std::move(state.positions);
  state.previous_velocities = std::move(state.velocities);
  state.previous_time_step = time_step;
  state.positions = std::move(end.positions);
  state.velocities = std::move(end.velocities);
  state.accelerations = std::move(end.accelerations);
  ++state.step;
}

}  // namespace

struct TimeStepper::Attempt {
  StepReport report{};
  Motion end{};
  VectorX gradient{};
};

TimeStepper::TimeStepper(const World& world)
    : integrator_(make_integrator(world.integrator, world.place + ": simulation.integrator")) {}

void TimeStepper::prepare(const World& world, State& state) const {
  Motion prescribed{state.positions, state.velocities, VectorX::Zero(state.positions.size())};
  prescribe_motion_at(world, state.time, prescribed);
  state.velocities = prescribed.velocities;
  if (integrator_->needs_accelerations() && state.accelerations.size() == 0)
    state.accelerations = accelerations_at(world, state, prescribed.accelerations);
}

TimeStepper::Attempt TimeStepper::attempt(const World& world, Newton& newton, const State& state,
                                          double time_step, const Integrator& integrator,
                                          const NewtonObserver& observer) const {
  Attempt attempt;
  StepReport& report = attempt.report;
  const History start = history_of(state);
  std::vector<Motion> solutions;
  for (int i = 0; i < integrator.num_stages(); ++i) {
    Stage stage = integrator.begin_stage(i, start, solutions, time_step);
    const VectorX& before = solutions.empty() ? start.now.positions : solutions.back().positions;
    const VectorX zero = VectorX::Zero(before.size());
    Motion prescribed{before, zero, zero};
    prescribe_motion(world, state, time_step, stage, prescribed);
    follow_prescribed(world, prescribed, stage);
    const Conditions conditions{.time = state.time + stage.time_fraction * time_step, .load = 1};
    const Inertia inertia(world.mass, stage.target(), stage.scale());
    const Potential potential(world, conditions, &inertia);
    VectorX x = before;
    choose_lower_start(potential, world.is_fixed, before, stage.target(), x);
    const NewtonReport search =
        newton.minimize(potential, world.is_fixed, prescribed.positions, newton_settings(world), x, observer);
    add_to(report.newton, search);
    if (search.status == NewtonReport::Status::interrupted) {
      report.status = StepReport::Status::interrupted;
      return attempt;
    }
    if (!search.converged()) {
      report.status = StepReport::Status::not_converged;
      report.reason = describe_failure(world, search, x);
    }
    potential.gradient(x, attempt.gradient);
    solutions.push_back(stage.motion(std::move(x)));
  }
  attempt.end = integrator.finish(start, std::move(solutions), time_step);
  prescribe_motion_at(world, state.time + time_step, attempt.end);
  return attempt;
}

StepReport TimeStepper::step(const World& world, Newton& newton, State& state, VectorX& gradient,
                             const NewtonObserver& observer) const {
  const double dt = world.time_step;
  Attempt found = attempt(world, newton, state, dt, *integrator_, observer);
  if (found.report.status == StepReport::Status::interrupted) return found.report;
  // The midpoint rule watches the middle of the way: beyond it a cell may turn inside out.
  if (!integrator_->solves_for_end() &&
      !is_in_domain(world, found.end.positions, {.time = state.time + dt, .load = 1})) {
    const NewtonReport before = found.report.newton;
    found = attempt(world, newton, state, dt, BackwardEuler(), observer);
    NewtonReport sum = before;
    add_to(sum, found.report.newton);
    found.report.newton = sum;
    if (found.report.status == StepReport::Status::interrupted) return found.report;
    found.report.status = StepReport::Status::not_converged;
    found.report.reason = "the step would have inverted an element, so that backward_euler took it" +
                          (found.report.reason.empty() ? "" : "; " + found.report.reason);
  }
  gradient = std::move(found.gradient);
  move_to(state, std::move(found.end), dt);
  state.time = state.step * dt;
  return found.report;
}

}  // namespace resilin
