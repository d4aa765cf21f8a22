#include "resilin/simulation/time_stepping.hpp"

#include <algorithm>
#include <cmath>

#include "resilin/core/text.hpp"
#include "resilin/integrator/backward_euler.hpp"
#include "resilin/simulation/initial_acceleration.hpp"
#include "resilin/simulation/potential.hpp"
#include "resilin/world/colliders.hpp"
#include "resilin/world/damping.hpp"

namespace resilin {
namespace {

/// Times count as equal within this [s]; loads and prescribed motions see them so, too.
double slack(double time) { return 2e-9 * std::max(1.0, std::abs(time)); }

bool is_event(const World& world, double time) {
  return std::ranges::any_of(world.event_times,
                             [time](double event) { return std::abs(event - time) <= slack(time); });
}

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

/// The accelerations that the loads and the prescribed motions give from now on.
VectorX accelerations_from(const World& world, State state) {
  state.time += 2 * slack(state.time);
  const VectorX zero = VectorX::Zero(state.positions.size());
  Motion prescribed{state.positions, zero, zero};
  prescribe_motion_at(world, state.time, prescribed);
  return accelerations_at(world, state, prescribed.accelerations);
}

/// About the shape at a stage's time, to the order of the integrator: where damping is formed.
VectorX expected_shape(const Integrator& integrator, const History& start,
                       const std::vector<Motion>& solutions, const Stage& stage, double time_step) {
  if (integrator.order() == 1) return start.now.positions;
  if (solutions.empty()) return start.now.positions + stage.time_fraction * time_step * start.now.velocities;
  // The stage before ended at x with v; for a second stage the rest of the step is what is left of it.
  const Motion& last = solutions.back();
  const double passed = 2 * stage.duration;  // TR-BDF2: the first stage is as long as both its halves
  return last.positions + (time_step - passed) * last.velocities;
}

bool is_in_domain(const World& world, const VectorX& x, const Conditions& conditions) {
  double sum = 0;
  for (const auto& energy : world.elastic) sum += energy->value(x, conditions);
  for (const auto& collider : world.colliders) sum += collider->value(x, conditions);
  return std::isfinite(sum);
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

/// Newton's method on one stage, from x. Where bodies are in the way of moving colliders these go as far as
/// they can without touching them, a few iterations let the bodies give way, and so on;
/// `conditions.collider_delay` is how far they are behind at first, and becomes how far they still are.
struct StageSolver {
  static constexpr int most_advances = 100;
  static constexpr int iterations_to_give_way = 3;

  const World& world;
  Newton& newton;
  const Inertia& inertia;
  std::span<const std::unique_ptr<Energy>> damping;
  const VectorX& prescribed;  ///< places of the fixed unknowns
  const NewtonObserver& observer;

  NewtonReport solve(Conditions& conditions, const VectorX& guess, VectorX& x) const {
    NewtonReport total;
    const VectorX held = x;
    for (int advance = 0;; ++advance) {
      conditions.collider_delay = least_collider_delay(world, x, conditions);
      const bool is_last = conditions.collider_delay == 0 || advance == most_advances;
      const Potential potential(world, conditions, &inertia, damping);
      if (advance == 0) choose_lower_start(potential, world.is_fixed, held, guess, x);
      NewtonSettings settings = newton_settings(world);
      if (!is_last) settings.max_iterations = std::min(settings.max_iterations, iterations_to_give_way);
      add_to(total, newton.minimize(potential, world.is_fixed, prescribed, settings, x, observer));
      if (is_last || total.status == NewtonReport::Status::interrupted) return total;
    }
  }
};

void move_to(State& state, Motion end, double time_step, double collider_delay) {
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
    start.now.accelerations = accelerations_from(world, state);
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
    const Inertia inertia(world.mass, stage.target(), stage.scale());
    const VectorX shape = expected_shape(integrator, start, solutions, stage, time_step);
    const auto damping = damping_terms(world, shape, stage.base_positions, stage.duration);
    VectorX x = before;
    const NewtonReport search =
        StageSolver{world, newton, inertia, damping, prescribed.positions, observer}.solve(conditions,
                                                                                           stage.target(), x);
    add_to(report.newton, search);
    if (search.status == NewtonReport::Status::interrupted) {
      report.status = StepReport::Status::interrupted;
      return attempt;
    }
    if (!search.converged()) {
      report.status = StepReport::Status::not_converged;
      report.reason = describe_failure(world, search, x);
    }
    if (conditions.collider_delay > 0) {
      report.status = StepReport::Status::not_converged;
      report.reason = "bodies are in the way of a moving collider, which is " +
                      format_short(conditions.collider_delay) + " s behind its motion" +
                      (report.reason.empty() ? "" : "; " + report.reason);
    }
    colliders_reached = conditions.time - conditions.collider_delay;
    attempt.collider_delay = conditions.collider_delay;
    Potential(world, conditions, &inertia, damping).gradient(x, attempt.gradient);
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
  if (is_in_domain(world, found.end.positions, end)) {
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
  if (world.adaptive) return adaptive_step(world, newton, state, gradient, observer);
  const double dt = world.time_step;
  Attempt found = safe_attempt(world, newton, state, dt, observer);
  if (found.report.status == StepReport::Status::interrupted) return found.report;
  found.report.time_step = dt;
  gradient = std::move(found.gradient);
  move_to(state, std::move(found.end), dt, found.collider_delay);
  state.time = state.step * dt;
  return found.report;
}

StepReport TimeStepper::adaptive_step(const World& world, Newton& newton, State& state, VectorX& gradient,
                                      const NewtonObserver& observer) const {
  const AdaptiveSteps& options = *world.adaptive;
  const double tolerance = options.tolerance * world.largest_extent();
  const double shortest = options.min_step.value_or(1e-6 * world.time_step);
  const double longest = std::max(shortest, options.max_step.value_or(world.end_time));
  double wanted = std::clamp(state.time_step, shortest, longest);
  NewtonReport spent;
  for (int failed_attempts = 0;; ++failed_attempts) {
    const PlannedStep planned = plan_step(world, state, wanted);
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
    move_to(state, std::move(found.end), planned.length, found.collider_delay);
    state.time = planned.end;
    // A step cut short at an event says nothing against longer ones.
    const double next = fitting * planned.length;
    state.time_step = std::clamp(planned.is_cut ? std::max(next, wanted) : next, shortest, longest);
    return report;
  }
}

}  // namespace resilin
