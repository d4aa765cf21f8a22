#include "resilin/simulation/time_stepping.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "resilin/core/text.hpp"
#include "resilin/integrator/backward_euler.hpp"
#include "resilin/simulation/energy_guard.hpp"
#include "resilin/simulation/initial_acceleration.hpp"
#include "resilin/simulation/potential.hpp"
#include "resilin/simulation/prescribed_motion.hpp"
#include "resilin/simulation/stage_solver.hpp"

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

/// The accelerations that the loads and the prescribed motions give from now on.
VectorX accelerations_from(const World& world, State state) {
  state.time += 2 * slack(state.time);
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

/// The angle that a support turns by in a step [degrees]; the first one begins where nothing has turned.
double turn_of_step(const World& world, const State& state, double time_step) {
  const Conditions begin{.time = state.time}, end{.time = state.time + time_step};
  double turn = largest_turn(world.supports, begin, end);
  if (state.step > 0) return turn;
  for (const Support& support : world.supports) {
    if (support.rotate)
      turn = std::max(turn, std::abs(support.rotate->degrees * support.time_function.factor(end.time, 1)));
  }
  return turn;
}

int parts_of_turn(double turn) {
  return std::max(1, static_cast<int>(std::ceil(turn / largest_turn_of_step - 1e-9)));
}

/// Whether none of the equal parts of a step turns a support too far.
bool turns_evenly(const World& world, const State& state, double length, int num_parts) {
  if (num_parts == 1) return true;
  double turn = turn_of_step(world, state, length);
  for (int part = 1; part < num_parts; ++part) {
    const double begin = state.time + part * length;
    turn = std::max(turn, largest_turn(world.supports, {.time = begin}, {.time = begin + length}));
  }
  return turn <= largest_turn_of_step * (1 + 1e-9);
}

/// The world with supports that turn evenly from the start of a step to its end, whatever their functions do
/// in between.
World with_even_turns(const World& world, const State& state, double time_step) {
  World even = world;
  const double end = state.time + time_step;
  for (Support& support : even.supports) {
    if (!support.rotate) continue;
    const TimeFunction& f = support.time_function;
    const double before = state.step > 0 ? f.factor(state.time, 1) : 0;
    support.time_function = {TimeFunction::Table{{state.time, end}, {before, f.factor(end, 1)}}};
  }
  return even;
}

VectorX contact_accelerations(const World& world, const State& state) {
  const Conditions now{.time = state.time, .load = 1, .collider_delay = state.collider_delay};
  const Potential potential(world, now, static_stage(state.positions));
  return accelerations_by(world, -potential.gradient_of(EnergyCategory::contact, state.positions));
}

/// Of the largest kinetic energy so far, by which the energy may be above the least it has been: schemes keep
/// it only on average. Half of what tests/simulation/energy_test.cpp allows.
constexpr double energy_tolerance = 5e-4;

}  // namespace

struct TimeStepper::Attempt {
  StepReport report{};
  Motion end{};
  VectorX gradient{};
  double collider_delay = 0;        ///< [s]
  bool touches = false;             ///< contact acts, or would if the step had been found
  VectorX contact_accelerations{};  ///< at the end, where they are wanted; empty: none [m/s^2]
  VectorX jump{};                   ///< of the velocities by contact in the last stage, the same
  double jump_effect = 0;           ///< see follow_jump [s]
  VectorX slowing{};                ///< of the velocities, lest the step add energy; empty: none
  double energy_excess = 0, largest_kinetic_energy = 0;  ///< as in State

  bool converged() const { return report.status == StepReport::Status::converged; }
  bool is_interrupted() const { return report.status == StepReport::Status::interrupted; }
  /// Whether the step adds no energy; takes out of its velocities what it does, within bodies or, as the last
  /// resort, wherever it is.
  /// @param round_off  [J]
  bool keeps_energy(const World& world, const State& start, double time_step, double round_off,
                    bool is_last_resort);
  void move(State& state, double time_step) &&;
};

bool TimeStepper::Attempt::keeps_energy(const World& world, const State& start, double time_step,
                                        double round_off, bool is_last_resort) {
  const Conditions after{.time = start.time + time_step, .load = 1, .collider_delay = collider_delay};
  const EnergyChange change = energy_change(world, start, end, after);
  const double before = std::max(start.largest_kinetic_energy, change.kinetic_before);
  const double found = start.energy_excess + change.added;
  // What Newton's method leaves of the forces does work, too.
  const double left = converged() ? report.newton.residual * (end.positions - start.positions).norm() : 0;
  const double allowed = energy_tolerance * std::max(before, change.kinetic_after) + left + round_off;
  energy_excess = std::max(0.0, found);
  largest_kinetic_energy = std::max(before, change.kinetic_after);
  if (found <= allowed) return true;
  const VectorX velocities = end.velocities;
  const bool is_slowed =
      slow_down(world, end.positions, found - allowed, true, end.velocities) ||
      (is_last_resort && slow_down(world, end.positions, found - allowed, false, end.velocities));
  if (!is_slowed && !is_last_resort) return false;
  energy_excess = allowed;
  if (!is_slowed) return true;
  slowing = end.velocities - velocities;
  report.removed_energy = found - allowed;
  largest_kinetic_energy = std::max(before, change.kinetic_after - report.removed_energy);
  return true;
}

void TimeStepper::Attempt::move(State& state, double time_step) && {
  state.previous_positions = std::move(state.positions);
  state.previous_velocities = std::move(state.velocities);
  if (jump.size() > 0)
    follow_jump(jump, time_step, jump_effect, state.previous_positions, state.previous_velocities);
  if (slowing.size() > 0)
    follow_jump(slowing, time_step, 0, state.previous_positions, state.previous_velocities);
  state.previous_time_step = time_step;
  state.positions = std::move(end.positions);
  state.velocities = std::move(end.velocities);
  state.accelerations = std::move(end.accelerations);
  state.collider_delay = collider_delay;
  state.energy_excess = energy_excess;
  state.largest_kinetic_energy = largest_kinetic_energy;
  ++state.step;
}

TimeStepper::TimeStepper(const World& world)
    : integrator_(make_integrator(world.integrator, world.place + ": simulation.integrator")),
      strain_stiffness_(strain_stiffness(world)) {}

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
  History seen = start;  // without the impulses of contact in the stages
  std::vector<Motion> solutions;
  double colliders_reached = state.time - state.collider_delay;
  for (int i = 0; i < integrator.num_stages(); ++i) {
    Stage stage = integrator.begin_stage(i, seen, solutions, time_step);
    const VectorX& before = solutions.empty() ? start.now.positions : solutions.back().positions;
    const VectorX zero = VectorX::Zero(before.size());
    Motion prescribed{before, zero, zero};
    prescribe_motion(world, state, time_step, stage, prescribed);
    follow_prescribed(world, prescribed, stage);
    Conditions conditions{.time = state.time + stage.time_fraction * time_step, .load = 1};
    const double end = conditions.time + stage.time_to_end();
    conditions.collider_delay = end - colliders_reached;
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
      attempt.touches |= !(potential.energy(EnergyCategory::contact, guess) == 0);
    }
    if (conditions.collider_delay > 0) {
      report.status = StepReport::Status::not_converged;
      report.reason = "bodies are in the way of a moving collider, which is " +
                      format_short(conditions.collider_delay) + " s behind its motion" +
                      (report.reason.empty() ? "" : "; " + report.reason);
    }
    colliders_reached = end - conditions.collider_delay;
    attempt.collider_delay = conditions.collider_delay;
    potential.gradient(x, attempt.gradient);
    const VectorX contact = potential.gradient_of(EnergyCategory::contact, x);
    Motion found = stage.motion(std::move(x));
    attempt.jump.resize(0);
    attempt.contact_accelerations.resize(0);
    if (!contact.isZero(0)) {
      attempt.touches = true;
      // How often a stage takes the forces of contact, so that they act as long as the stage lasts.
      const double often = stage.contact_weight * stage.end_slope();
      attempt.gradient += (1 / often - 1) * contact;
      if (integrator_->looks_back() || world.adaptive) {
        const VectorX by_contact = accelerations_by(world, -contact);
        found.accelerations -= by_contact;
        attempt.contact_accelerations = by_contact / often;
        attempt.jump = stage.end_slope() * stage.duration * by_contact;
        attempt.jump_effect = stage.duration;
        follow_jump(attempt.jump, end - state.time, stage.duration, seen.now.positions, seen.now.velocities);
      }
    }
    solutions.push_back(std::move(found));
  }
  attempt.end = integrator.finish(start, std::move(solutions), time_step);
  prescribe_motion_at(world, state.time + time_step, attempt.end);
  return attempt;
}

TimeStepper::Attempt TimeStepper::safe_attempt(const World& world, Newton& newton, const State& state,
                                               double time_step, const NewtonObserver& observer) const {
  const BackwardEuler backward_euler;
  const bool is_safest = integrator_->name() == backward_euler.name();
  Attempt found = attempt(world, newton, state, time_step, *integrator_, observer);
  if (found.is_interrupted()) return found;
  // Cut short before contact is found, other schemes turn velocities around far from any collider.
  const bool is_lost = !found.converged() && found.touches && !is_safest;
  const double round_off = round_off_energy(world, strain_stiffness_, state.positions, time_step);
  if (!is_lost && found.keeps_energy(world, state, time_step, round_off, is_safest)) return found;
  const Conditions end{.time = state.time + time_step, .load = 1, .collider_delay = found.collider_delay};
  const bool leaves_domain =
      !Potential(world, end, static_stage(state.positions)).is_in_domain(found.end.positions);
  Attempt other = attempt(world, newton, state, time_step, backward_euler, observer);
  std::swap(found.report.newton, other.report.newton);
  add_to(other.report.newton, found.report.newton);
  if (other.is_interrupted()) return other;
  other.keeps_energy(world, state, time_step, round_off, true);
  other.report.by_backward_euler = true;
  if (leaves_domain) {
    other.report.status = StepReport::Status::not_converged;
    other.report.reason = "the step would have inverted an element, so that backward_euler took it" +
                          (other.report.reason.empty() ? "" : "; " + other.report.reason);
  }
  return other;
}

StepReport TimeStepper::step(const World& world, Newton& newton, State& state, VectorX& gradient,
                             const NewtonObserver& observer) const {
  if (world.adaptive) return adaptive_step(world, newton, state, gradient, observer);
  const double dt = world.time_step;
  const int number = state.step + 1;
  const int num_parts = parts_of_turn(turn_of_step(world, state, dt));
  StepReport report = step_in_parts(world, newton, state, gradient, dt, num_parts, observer);
  if (report.status != StepReport::Status::interrupted) state.time = number * dt;
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
    report.by_backward_euler |= found.report.by_backward_euler;
    report.removed_energy += found.report.removed_energy;
    if (!found.converged()) {
      report.status = found.report.status;
      report.reason = found.report.reason;
    }
    if (found.is_interrupted()) return report;
    gradient = std::move(found.gradient);
    std::move(found).move(now, length);
    now.time = state.time + part * length;
  }
  now.step = state.step + 1;
  state = std::move(now);
  report.time_step = time_step;
  return report;
}

double TimeStepper::step_error(const World& world, const State& state, const Attempt& found,
                               double time_step) const {
  History start = history_of(state);
  Motion end = found.end;
  if (found.contact_accelerations.size() > 0) end.accelerations += found.contact_accelerations;
  start.now.accelerations += contact_accelerations(world, state);
  return largest_free_distance(world, integrator_->local_error(start, end, time_step));
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
    PlannedStep planned = plan_step(world, state, wanted);
    int num_parts = parts_of_turn(turn_of_step(world, state, planned.length));
    while (num_parts > 1 && planned.length > shortest * (1 + 1e-9) &&
           turns_evenly(world, state, planned.length / num_parts, num_parts)) {
      wanted = std::max(shortest, planned.length / num_parts);
      planned = plan_step(world, state, wanted);
      num_parts = parts_of_turn(turn_of_step(world, state, planned.length));
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
    if (found.is_interrupted()) return report;
    report.time_step = planned.length;
    report.time_error = step_error(world, state, found, planned.length);
    // The error of a step grows with its length to the power order + 1.
    const double error = report.time_error / tolerance;
    const bool is_of_scheme = found.converged() && !report.by_backward_euler && report.removed_energy == 0;
    const double fitting =
        is_of_scheme && std::isfinite(error)
            ? std::clamp(0.9 * std::pow(error, -1.0 / (integrator_->order() + 1)), 0.2, 2.0)
            : 0.5;
    const bool is_accepted = is_of_scheme && error <= 1;
    if (!is_accepted && planned.length > shortest * (1 + 1e-9)) {
      wanted = std::max(shortest, std::min(0.9, fitting) * planned.length);
      continue;
    }
    if (!(error <= 1)) {
      report.status = StepReport::Status::not_converged;
      if (report.reason.empty()) {
        report.reason = "the shortest step misplaces a vertex by about " + format_number(report.time_error) +
                        " m, more than the tolerance of " + format_number(tolerance) + " m";
      }
    }
    gradient = std::move(found.gradient);
    StepReport done = std::move(report);
    std::move(found).move(state, planned.length);
    state.time = planned.end;
    // A step cut short at an event says nothing against longer ones.
    const double next = fitting * planned.length;
    state.time_step = std::clamp(planned.is_cut ? std::max(next, wanted) : next, shortest, longest);
    return done;
  }
}

}  // namespace resilin
