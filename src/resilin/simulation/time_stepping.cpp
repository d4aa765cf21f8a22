#include "resilin/simulation/time_stepping.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "resilin/core/text.hpp"
#include "resilin/energy/time_function.hpp"
#include "resilin/simulation/energy_guard.hpp"
#include "resilin/simulation/force_balance.hpp"
#include "resilin/simulation/initial_acceleration.hpp"
#include "resilin/simulation/potential.hpp"
#include "resilin/simulation/prescribed_motion.hpp"
#include "resilin/simulation/stage_plan.hpp"
#include "resilin/simulation/stage_solver.hpp"
#include "resilin/simulation/step_attempt.hpp"
#include "resilin/simulation/turning_step.hpp"
#include "resilin/world/linear_constraints.hpp"

namespace resilin {
namespace {

/// Whether supports are where they should be.
bool follows(const World& world, const VectorX& positions, const VectorX& prescribed) {
  bool is_astray = false;
  for (Eigen::Index i = 0; i < positions.size() && !is_astray; ++i)
    is_astray = world.is_fixed[static_cast<std::size_t>(i)] != 0 && positions[i] != prescribed[i] &&
                !(world.constraints && world.dependents()->is_dependent(static_cast<Index>(i)));
  return !world.share.any(is_astray);
}

/// So often is a step cut in two that has no solution.
constexpr int most_halvings_of_step = 3;

/// Whether a step has no solution, and not because limits below their defaults cut it short on purpose.
bool is_lost(const World& world, const StepReport& report) {
  if (report.status == StepReport::Status::interrupted) return false;
  const bool may_settle = world.friction_iterations >= ContactDescription{}.friction_iterations;
  return !report.has_solution || (may_settle && report.friction.mismatch > largest_balance_error);
}

}  // namespace

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

History TimeStepper::start_of_step(const World& world, const State& state, double time_step) const {
  History start = history_of(state);
  if (is_event(world, state.time)) start.now.accelerations = accelerations_from(world, state, time_step);
  return start;
}

TimeStepper::Attempt TimeStepper::attempt(const World& world, Newton& newton, const State& state,
                                          double time_step, const Integrator& integrator,
                                          const NewtonObserver& observer) const {
  Attempt attempt;
  StepReport& report = attempt.report;
  attempt.scheme = &integrator;
  const History start =
      integrator.needs_accelerations() ? start_of_step(world, state, time_step) : history_of(state);
  StageSequence& stages = attempt.stages.emplace(integrator, start, time_step);
  const bool keeps_impulses_out = integrator_->looks_back() || world.adaptive;
  double colliders_reached = state.time - state.collider_delay;
  bool supports_are_reached = true;
  for (int i = 0; i < integrator.num_stages(); ++i) {
    const VectorX& before = stages.last_positions();
    StagePlan plan = plan_in_motion(world, state, time_step, stages.begin(), before);
    const Stage& stage = plan.stage;
    const double end = plan.conditions.time + stage.time_to_end();
    plan.conditions.delay = end - colliders_reached;
    Potential potential = Potential::in_stage(world, state, plan.conditions, stage);
    VectorX x = before;
    const Flight flying = flight(world, world.is_fixed, potential, stage, world.gravity, x);
    const StageReport searched =
        solve_stage(potential, world.is_fixed, plan.targets, flying, newton_settings(world),
                    {.friction_rounds = world.friction_iterations}, newton, x, observer);
    const NewtonReport& search = searched.newton;
    report.friction.add(searched);
    supports_are_reached &= follows(world, x, plan.targets);
    const double delay = potential.conditions().delay;
    add_to(report.newton, search);
    if (search.status == NewtonReport::Status::interrupted) {
      report.status = StepReport::Status::interrupted;
      return attempt;
    }
    if (!search.converged()) {
      const bool is_cut_short = search.status == NewtonReport::Status::max_iterations &&
                                world.newton.max_iterations < NewtonOptions{}.max_iterations;
      attempt.add(is_cut_short ? Flaw::cut_short : Flaw::not_found, describe_failure(world, search, x),
                  searched.flew);
      attempt.touches |= !(potential.energy(EnergyCategory::contact, flying.places) == 0);
    }
    potential.gradient(x, attempt.gradient);
    // Energies are compared where the run ends: they cost as much as a step of Newton's method.
    const bool is_last = state.time + time_step >= world.end_time - time_slack(world.end_time);
    const VectorX displacement = is_last ? VectorX(x - start.now.positions) : VectorX();
    if (searched.friction_mismatch > largest_balance_error) {
      attempt.add(Flaw::unsettled_friction, describe_unsettled_friction(searched));
    } else if (search.converged()) {
      std::string imbalance = describe_imbalance(world, potential, x, attempt.gradient, search, displacement);
      if (!imbalance.empty()) attempt.add(Flaw::out_of_balance, std::move(imbalance));
    }
    if (delay > 0) {
      std::string reason = "bodies block a moving collider, which is " + format_short(delay) +
                           " s behind its motion" + (report.reason.empty() ? "" : "; " + report.reason);
      // Where a search has failed, its flaw decides: a shorter step may let the collider pass.
      if (search.converged())
        attempt.add(Flaw::blocked, std::move(reason));
      else
        report.reason = std::move(reason);
    }
    colliders_reached = end - delay;
    attempt.collider_delay = delay;
    attempt.friction_work += potential.heat_of_friction(before, x, stage.length());
    const VectorX contact = potential.impulses(x);
    attempt.contact_accelerations.resize(0);
    VectorX impulses;  // accelerations by contact, where they are kept out
    if (world.share.any(!contact.isZero(0))) {
      attempt.touches = true;
      const double often = stage.count_of_impulse();
      VectorX passed_on = contact;
      if (world.constraints) world.dependents()->add_forces(passed_on);
      attempt.gradient += (1 / often - 1) * passed_on;
      if (keeps_impulses_out) {
        impulses = accelerations_by(world, -contact);
        attempt.contact_accelerations = impulses / often;
      }
    }
    if (i > 0) report.stage_places.push_back(before);
    stages.end(stage, stage.motion(std::move(x)), impulses);
    attempt.last_stage = std::move(plan.stage);
  }
  attempt.end = stages.finish();
  // Supports whose motion was in the way of something stay where the search has led them: beyond, surfaces
  // may go through each other and cells be inside out. The next step leads them on from there.
  if (supports_are_reached) prescribe_motion_at(world, state.time + time_step, attempt.end);
  attempt.history = state.history;
  attempt.history_heat = world.share.sum(
      advance_history(world.terms, state.positions, attempt.end.positions, time_step, attempt.history));
  return attempt;
}

TimeStepper::Attempt TimeStepper::safe_attempt(const World& world, Newton& newton, const State& state,
                                               double time_step, const NewtonObserver& observer) const {
  const bool is_safest = integrator_->name() == safest_.name();
  Attempt found = attempt(world, newton, state, time_step, *integrator_, observer);
  if (found.is_interrupted()) return found;
  const bool is_turned = found.touches && found.remedies.backward_euler && !is_safest;
  const double round_off = round_off_energy(world, strain_stiffness_, state.positions, time_step);
  if (!is_turned && found.keeps_energy(world, state, time_step, round_off, is_safest)) return found;
  const Conditions end = conditions_after(state, time_step, found.collider_delay);
  const bool leaves_domain = !Potential::in_stage(world, state, end, static_stage(state.positions))
                                  .is_in_domain(found.end.positions);
  Attempt other = attempt(world, newton, state, time_step, safest_, observer);
  std::swap(found.report.newton, other.report.newton);
  add_to(other.report.newton, found.report.newton);
  if (other.is_interrupted()) return other;
  other.keeps_energy(world, state, time_step, round_off, true);
  other.report.by_backward_euler = true;
  if (leaves_domain)
    other.add(Flaw::leaves_domain, "the step would have inverted an element, so backward_euler was used" +
                                       (other.report.reason.empty() ? "" : "; " + other.report.reason));
  return other;
}

// A step without a solution is one that bodies are thrown through too far, or whose friction pushes them from
// one side of a corner to the other: shorter ones have one. So may steps in which a collider falls behind.
StepReport TimeStepper::step(const World& world, Newton& newton, State& state, VectorX& gradient,
                             const NewtonObserver& observer) const {
  if (world.adaptive) return adaptive_step(world, *world.adaptive, newton, state, gradient, observer);
  const double dt = world.time_step;
  // Multiples of the step carry no sum of rounding errors. A run that went on with steps of another length is
  // not on them.
  const double end = state.time == state.step * dt ? (state.step + 1) * dt : state.time + dt;
  const int num_parts = num_steps_of_turn(turn_of_step(world, state, dt));
  State next;
  StepReport report =
      step_in_parts(world, newton, state, next, gradient, dt, num_parts, WhenLost::go_on, observer);
  const bool may_be_cut_short = world.newton.max_iterations < NewtonOptions{}.max_iterations;
  bool is_in_vain =
      is_lost(world, report) || (!may_be_cut_short && state.collider_delay == 0 && next.collider_delay > 0);
  for (int halving = 1; halving <= most_halvings_of_step && is_in_vain; ++halving) {
    State divided;
    VectorX gradient_of_last;
    StepReport shorter = step_in_parts(world, newton, state, divided, gradient_of_last, dt,
                                       num_parts << halving, WhenLost::stop, observer);
    if (shorter.status == StepReport::Status::interrupted) return shorter;
    is_in_vain = divided.step != state.step + 1;  // it stopped
    if (is_in_vain) {
      add_counts(report.newton, shorter.newton);
    } else {
      add_counts(shorter.newton, report.newton);
      report = std::move(shorter);
      next = std::move(divided);
      gradient = std::move(gradient_of_last);
      ++next.divided_steps;
    }
    report.failed_attempts = halving;
  }
  if (report.status == StepReport::Status::interrupted) return report;
  state = std::move(next);
  state.time = end;
  return report;
}

StepReport TimeStepper::step_in_parts(const World& world, Newton& newton, const State& start, State& end,
                                      VectorX& gradient, double time_step, int num_parts, WhenLost when_lost,
                                      const NewtonObserver& observer) const {
  StepReport report;
  State now = start;
  const double length = time_step / num_parts;
  std::optional<World> even;
  if (!turns_evenly(world, start, length, num_parts)) even = with_even_turns(world, start, time_step);
  for (int part = 1; part <= num_parts; ++part) {
    Attempt found = safe_attempt(even ? *even : world, newton, now, length, observer);
    add_to(report.newton, found.report.newton);
    report.friction.add(found.report.friction);
    report.by_backward_euler |= found.report.by_backward_euler;
    report.removed_energy += found.report.removed_energy;
    report.has_solution &= found.report.has_solution;
    if (!found.converged()) {
      report.status = found.report.status;
      report.reason = found.report.reason;
    }
    const bool is_in_vain = is_lost(world, report) || found.collider_delay > 0;
    if (found.is_interrupted() || (when_lost == WhenLost::stop && is_in_vain)) return report;
    report.stage_places = std::move(found.report.stage_places);
    gradient = std::move(found.gradient);
    std::move(found).move(world, now, length, start.time + part * length);
  }
  now.step = start.step + 1;
  now.guarded_steps = std::min(now.guarded_steps, start.guarded_steps + 1);
  end = std::move(now);
  report.time_step = time_step;
  return report;
}

}  // namespace resilin
