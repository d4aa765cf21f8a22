#include "resilin/simulation/time_stepping.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "resilin/core/text.hpp"
#include "resilin/energy/time_function.hpp"
#include "resilin/integrator/backward_euler.hpp"
#include "resilin/simulation/force_balance.hpp"
#include "resilin/simulation/initial_acceleration.hpp"
#include "resilin/simulation/potential.hpp"
#include "resilin/simulation/prescribed_motion.hpp"
#include "resilin/simulation/stage_solver.hpp"
#include "resilin/simulation/turning_step.hpp"

namespace resilin {
namespace {

bool is_event(const World& world, double time) {
  return std::ranges::any_of(world.event_times,
                             [time](double event) { return std::abs(event - time) <= 2 * time_slack(time); });
}

History history_of(const State& state) {
  return {.now = {state.positions, state.velocities, state.accelerations},
          .previous_positions = state.previous_positions,
          .previous_velocities = state.previous_velocities,
          .previous_time_step = state.previous_time_step};
}

/// The accelerations that the loads and the prescribed motions give from now on, where a step begins.
VectorX accelerations_from(const World& world, State state, double time_step) {
  state.time += 4 * std::max(time_slack(state.time), time_slack(time_step));
  const VectorX zero = VectorX::Zero(state.positions.size());
  Motion prescribed{state.positions, zero, zero};
  prescribe_motion_at(world, state.time, prescribed);
  return accelerations_at(world, state, prescribed.accelerations);
}

struct PlannedStep {
  double length;  ///< [s]
  double end;     ///< [s]; an event exactly where the step meets one
  bool is_cut;    ///< it would be longer if there were no event
};

/// A step of the length `wanted`, or of what is left until the next event or the end: all of it when it is no
/// longer, half of it when it is less than twice as long, so that no sliver is left over.
PlannedStep plan_step(const World& world, const State& state, double wanted) {
  const double meaningful = 1e-9 * std::max(world.end_time, world.time_step);
  double event = world.end_time;
  for (const double time : world.event_times) {
    if (time > state.time + meaningful && time < event - meaningful) event = time;
  }
  const double left = event - state.time;
  if (wanted >= left * (1 - 1e-9)) return {left, event, true};
  if (2 * wanted > left) return {left / 2, state.time + left / 2, true};
  return {wanted, state.time + wanted, false};
}

/// The longest vector of a node in `vectors`, its fixed components left out.
double largest_free_distance(const World& world, const VectorX& vectors) {
  double largest = 0;
  for (Index node = 0; node < world.num_nodes(); ++node) {
    double square = 0;
    for (int k = 0; k < world.dimension; ++k) {
      const Eigen::Index i = Eigen::Index{node} * world.dimension + k;
      if (world.is_fixed[static_cast<std::size_t>(i)] == 0) square += vectors[i] * vectors[i];
    }
    largest = square > largest || std::isnan(square) ? square : largest;
  }
  return std::sqrt(largest);
}

/// What damping takes on the way to `end` [J].
double dissipation(const World& world, const State& state, const Motion& end, double time_step) {
  double sum = 0;
  for (const auto& term : world.terms) sum += term->dissipation(state.positions, end.positions, time_step);
  return sum;
}

void move_to(const World& world, State& state, Motion end, double time_step, double collider_delay) {
  state.dissipated_energy += dissipation(world, state, end, time_step);
  state.previous_positions = std::move(state.positions);
  state.previous_velocities = std::move(state.velocities);
  state.previous_time_step = time_step;
  state.positions = std::move(end.positions);
  state.velocities = std::move(end.velocities);
  state.accelerations = std::move(end.accelerations);
  state.collider_delay = collider_delay;
  ++state.step;
}

}  // namespace

struct TimeStepper::Attempt {
  StepReport report{};
  Motion end{};
  VectorX gradient{};
  double collider_delay = 0;  ///< [s]
};

TimeStepper::TimeStepper(const World& world)
    : integrator_(make_integrator(world.integrator, world.place + ": simulation.integrator")) {}

void TimeStepper::prepare(const World& world, State& state) const {
  const VectorX zero = VectorX::Zero(state.positions.size());
  Motion prescribed{state.positions, state.velocities, zero};
  prescribe_motion_at(world, state.time, prescribed);
  state.velocities = prescribed.velocities;
  if (state.time_step == 0) state.time_step = world.time_step;
  if ((integrator_->needs_accelerations() || world.adaptive) && state.accelerations.size() == 0)
    state.accelerations = accelerations_at(world, state, prescribed.accelerations);
}

TimeStepper::Attempt TimeStepper::attempt(const World& world, Newton& newton, const State& state,
                                          double time_step, const Integrator& integrator,
                                          const NewtonObserver& observer) const {
  Attempt attempt;
  StepReport& report = attempt.report;
  History start = history_of(state);
  if (integrator.needs_accelerations() && is_event(world, state.time))
    start.now.accelerations = accelerations_from(world, state, time_step);
  std::vector<Motion> solutions;
  double colliders_reached = state.time - state.collider_delay;
  for (int i = 0; i < integrator.num_stages(); ++i) {
    Stage stage = integrator.begin_stage(i, start, solutions, time_step);
    const VectorX& before = solutions.empty() ? start.now.positions : solutions.back().positions;
    const VectorX zero = VectorX::Zero(before.size());
    Motion prescribed{before, zero, zero};
    prescribe_motion(world, state, time_step, stage, prescribed);
    follow_prescribed(world, prescribed, stage);
    Conditions conditions{.time = state.time + stage.time_fraction * time_step, .load = 1};
    conditions.collider_delay = conditions.time - colliders_reached;
    Potential potential(world, conditions, stage);
    VectorX x = before;
    const VectorX guess = flight_guess(world, world.is_fixed, potential, stage, world.gravity, x);
    const NewtonReport search = solve_stage(potential, world.is_fixed, prescribed.positions, guess,
                                            newton_settings(world), {}, newton, x, observer);
    conditions = potential.conditions();
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
    // Energies are compared where the run ends: they cost as much as a step of Newton's method.
    const bool is_last = state.time + time_step >= world.end_time - time_slack(world.end_time);
    const VectorX displacement = is_last ? VectorX(x - start.now.positions) : VectorX();
    if (const std::string imbalance =
            search.converged()
                ? describe_imbalance(world, potential, x, attempt.gradient, search, displacement)
                : "";
        !imbalance.empty()) {
      report.status = StepReport::Status::not_converged;
      report.reason = imbalance;
    }
    if (conditions.collider_delay > 0) {
      report.status = StepReport::Status::not_converged;
      report.reason = "bodies are in the way of a moving collider, which is " +
                      format_short(conditions.collider_delay) + " s behind its motion" +
                      (report.reason.empty() ? "" : "; " + report.reason);
    }
    colliders_reached = conditions.time - conditions.collider_delay;
    attempt.collider_delay = conditions.collider_delay;
    solutions.push_back(stage.motion(std::move(x)));
  }
  attempt.end = integrator.finish(start, std::move(solutions), time_step);
  prescribe_motion_at(world, state.time + time_step, attempt.end);
  return attempt;
}

TimeStepper::Attempt TimeStepper::safe_attempt(const World& world, Newton& newton, const State& state,
                                               double time_step, const NewtonObserver& observer) const {
  Attempt found = attempt(world, newton, state, time_step, *integrator_, observer);
  if (found.report.status == StepReport::Status::interrupted || integrator_->solves_for_end()) return found;
  const Conditions end{.time = state.time + time_step, .load = 1};
  if (Potential(world, end, static_stage(state.positions)).is_in_domain(found.end.positions)) {
    found.collider_delay = 0;
    return found;
  }
  Attempt other = attempt(world, newton, state, time_step, BackwardEuler(), observer);
  std::swap(found.report.newton, other.report.newton);
  add_to(other.report.newton, found.report.newton);
  if (other.report.status == StepReport::Status::interrupted) return other;
  other.report.status = StepReport::Status::not_converged;
  other.report.reason =
      "the step would have inverted an element or met a collider, so that backward_euler took it" +
      (other.report.reason.empty() ? "" : "; " + other.report.reason);
  return other;
}

StepReport TimeStepper::step(const World& world, Newton& newton, State& state, VectorX& gradient,
                             const NewtonObserver& observer) const {
  if (world.adaptive) return adaptive_step(world, *world.adaptive, newton, state, gradient, observer);
  const double dt = world.time_step;
  // Multiples of the step carry no sum of rounding errors. A run that went on with steps of another length is
  // not on them.
  const double end = state.time == state.step * dt ? (state.step + 1) * dt : state.time + dt;
  const int num_parts = num_steps_of_turn(turn_of_step(world, state, dt));
  StepReport report = step_in_parts(world, newton, state, gradient, dt, num_parts, observer);
  if (report.status != StepReport::Status::interrupted) state.time = end;
  return report;
}

StepReport TimeStepper::step_in_parts(const World& world, Newton& newton, State& state, VectorX& gradient,
                                      double time_step, int num_parts, const NewtonObserver& observer) const {
  StepReport report;
  State now = state;
  const double length = time_step / num_parts;
  std::optional<World> even;
  if (!turns_evenly(world, state, length, num_parts)) even = with_even_turns(world, state, time_step);
  for (int part = 1; part <= num_parts; ++part) {
    Attempt found = safe_attempt(even ? *even : world, newton, now, length, observer);
    add_to(report.newton, found.report.newton);
    if (found.report.status != StepReport::Status::converged) {
      report.status = found.report.status;
      report.reason = found.report.reason;
    }
    if (report.status == StepReport::Status::interrupted) return report;
    gradient = std::move(found.gradient);
    move_to(world, now, std::move(found.end), length, found.collider_delay);
    now.time = state.time + part * length;
  }
  now.step = state.step + 1;
  state = std::move(now);
  report.time_step = time_step;
  return report;
}

StepReport TimeStepper::adaptive_step(const World& world, const AdaptiveSteps& options, Newton& newton,
                                      State& state, VectorX& gradient, const NewtonObserver& observer) const {
  const double tolerance = options.tolerance * world.largest_extent();
  const double shortest = options.min_step.value_or(1e-6 * world.time_step);
  const double longest = std::max(shortest, options.max_step.value_or(world.end_time));
  double wanted = std::clamp(state.time_step, shortest, longest);
  NewtonReport spent;
  for (int failed_attempts = 0;; ++failed_attempts) {
    PlannedStep planned = plan_step(world, state, wanted);
    int num_parts = num_steps_of_turn(turn_of_step(world, state, planned.length));
    while (num_parts > 1 && planned.length > shortest * (1 + 1e-9) &&
           turns_evenly(world, state, planned.length / num_parts, num_parts)) {
      wanted = std::max(shortest, planned.length / num_parts);
      planned = plan_step(world, state, wanted);
      num_parts = num_steps_of_turn(turn_of_step(world, state, planned.length));
    }
    if (num_parts > 1) {  // a turn at once, or nearly so
      StepReport report = step_in_parts(world, newton, state, gradient, planned.length, num_parts, observer);
      if (report.status != StepReport::Status::interrupted) state.time = planned.end;
      return report;
    }
    Attempt found = safe_attempt(world, newton, state, planned.length, observer);
    StepReport& report = found.report;
    std::swap(spent, report.newton);
    add_to(report.newton, spent);
    spent = report.newton;
    report.failed_attempts = failed_attempts;
    if (report.status == StepReport::Status::interrupted) return report;
    const bool converged = report.status == StepReport::Status::converged;
    report.time_step = planned.length;
    report.time_error =
        largest_free_distance(world, integrator_->local_error(history_of(state), found.end, planned.length));
    // The error of a step grows with its length to the power order + 1.
    const double error = report.time_error / tolerance;
    const double fitting =
        converged && std::isfinite(error)
            ? std::clamp(0.9 * std::pow(error, -1.0 / (integrator_->order() + 1)), 0.2, 2.0)
            : 0.5;
    const bool is_accepted = converged && error <= 1;
    if (!is_accepted && planned.length > shortest * (1 + 1e-9)) {
      wanted = std::max(shortest, std::min(0.9, fitting) * planned.length);
      continue;
    }
    if (!is_accepted) {
      report.status = StepReport::Status::not_converged;
      if (report.reason.empty()) {
        report.reason = "the shortest step misplaces a vertex by about " + format_number(report.time_error) +
                        " m, more than the tolerance of " + format_number(tolerance) + " m";
      }
    }
    gradient = std::move(found.gradient);
    move_to(world, state, std::move(found.end), planned.length, found.collider_delay);
    state.time = planned.end;
    // A step cut short at an event says nothing against longer ones.
    const double next = fitting * planned.length;
    state.time_step = std::clamp(planned.is_cut ? std::max(next, wanted) : next, shortest, longest);
    return report;
  }
}

}  // namespace resilin
