#include <algorithm>
#include <cmath>
#include <limits>

#include "resilin/core/stopwatch.hpp"
#include "resilin/energy/hand.hpp"
#include "resilin/integrator/backward_euler.hpp"
#include "resilin/integrator/stage_sequence.hpp"
#include "resilin/live/kinetic_guard.hpp"
#include "resilin/live/live_contents.hpp"
#include "resilin/optimize/convergence.hpp"
#include "resilin/simulation/most_strained.hpp"
#include "resilin/simulation/stage_plan.hpp"
#include "resilin/simulation/stage_solver.hpp"
#include "resilin/world/linear_constraints.hpp"

namespace resilin {
namespace {

constexpr double overrun_weight = 0.1;       ///< weight of the last step in the mean of overruns
constexpr int steps_to_first_estimate = 30;  ///< steps before the first estimate of the discretisation error
constexpr int steps_between_estimates = 120;
constexpr double longest_mending_step = 10;  ///< [s], where bodies are held
constexpr double fall_while_mending = 0.05;  ///< largest fall in one step, relative to the extent
constexpr double quiet_speed = 1e-3;         ///< relative to the body's extent in a second
constexpr double rest_tolerance = 1e-8;      ///< relative to the load
constexpr double unloaded_force_scale =
    1e-4;  ///< relative to E times the body's cross section, where there is no load

}  // namespace

bool LiveScene::Contents::is_seeking() const {
  // Where friction holds bodies depends on how they came there, which a search for the equilibrium forgets.
  const bool rubs = std::ranges::any_of(
      terms, [](const auto& term) { return term->properties().category == EnergyCategory::friction; });
  const bool creeps = state.history.size() > 0;
  return !rubs && !creeps && !drives.any_moves() && state.time >= changes_end() &&
         calm.quiet_steps >= quiet_steps_before_seeking;
}

void LiveScene::Contents::step(const StepBudget& budget) {
  if (report.at_rest) return;
  const StepBudget for_iterations{budget.seconds - overrun};
  double seconds = 0;
  {
    const Stopwatch watch(seconds);
    advance_obstacles();
    is_seeking() ? move_to_equilibrium(for_iterations) : move_in_parts(for_iterations);
  }
  const double over = seconds - for_iterations.seconds;
  if (over > 0) overrun = std::min(overrun + overrun_weight * (over - overrun), budget.seconds);
  report.step_ms = 1e3 * seconds;
}

std::shared_ptr<const Hand> LiveScene::Contents::hand() const {
  if (!held) return nullptr;
  const Body& body = world.body_of(held->place.nodes.front());
  return std::make_shared<const Hand>(world.dimension, held->place, held->target,
                                      hand_stiffness(controls, world, body), controls.max_force);
}

Vector3 LiveScene::Contents::hand_force() const {
  const std::shared_ptr<const Hand> holding = hand();
  return holding ? holding->force(state.positions) : Vector3(Vector3::Zero());
}

Terms LiveScene::Contents::with_hand(Terms all) const {
  if (std::shared_ptr<const Hand> holding = hand()) all.push_back(std::move(holding));
  return all;
}

/// Newton's method from the better of where things are and where they would fly, until the tolerance or the
/// end of the time.
NewtonReport LiveScene::Contents::minimize(Potential& potential, const Flight& guess, const VectorX& targets,
                                           double tolerance, const StepBudget& budget, VectorX& x) {
  NewtonSettings settings = newton_settings(world);
  settings.tolerance = tolerance;
  settings.max_iterations = controls.newton_limit > 0 ? controls.newton_limit : world.newton.max_iterations;
  return solve_stage(potential, is_fixed, targets, guess, settings,
                     {.seconds = budget.seconds,
                      .iterations = settings.max_iterations,
                      .friction_rounds = world.friction_iterations},
                     newton, x)
      .newton;
}

/// A step in time; several where supports turn far in it.
void LiveScene::Contents::move_in_parts(const StepBudget& budget) {
  const double dt = controls.time_step;
  const double of_supports =
      largest_turn(world, {.time = scene_time(state.time)}, {.time = scene_time(state.time + dt)});
  const int num_parts = num_steps_of_turn(std::max(of_supports, drives.largest_turn(dt)));
  for (int part = 0; part < num_parts; ++part) move_in_time(dt / num_parts, budget);
}

void LiveScene::Contents::move_in_time(double dt, const StepBudget& budget) {
  count_mending_steps();
  if (drives.advance(dt, world)) {
    calm = {};
    is_as_run = false;
    renew_terms();
  }
  const double step = dt * mending_factor();
  const BackwardEuler scheme;
  StageSequence stages(scheme,
                       {.now = {.positions = state.positions,
                                .velocities = (dt / step) * (dt / step) * state.velocities,
                                .accelerations = {}}},
                       step);
  const double time = scene_time(state.time + dt);
  const Conditions conditions{.time = time,
                              .load = scene_load(state.time + dt),
                              .delay = state.collider_delay + time - scene_time(state.time)};
  const StagePlan plan = plan_stage(world, conditions, stages.begin(), state.positions);
  const bool is_driven = are_nodes_led(conditions, plan.targets);
  const Terms all = with_hand(terms);
  Potential potential(all, is_fixed, conditions, plan.stage, {}, state.history, world.dependents());
  VectorX x = state.positions;
  const NewtonReport newton_report =
      minimize(potential, flight(world, is_fixed, potential, plan.stage, controls.gravity, x), plan.targets,
               controls.tolerance, budget, x);
  stages.end(plan.stage, plan.stage.motion(std::move(x)));
  Motion end = stages.finish();
  if (!is_driven && !newton_report.converged()) {
    const double gain = potential.difference_without(EnergyCategory::inertia, state.positions, end.positions);
    limit_kinetic_energy(*world.mass, state.velocities, gain, end.velocities);
  }
  advance_history(world.terms, state.positions, end.positions, step, state.history);
  state.previous_positions = std::move(state.positions);
  state.positions = std::move(end.positions);
  state.velocities = std::move(end.velocities);
  state.time += dt;
  state.collider_delay = potential.conditions().delay;
  ++state.step;
  drives.follow_scene(this->conditions());
  measure(newton_report);
  estimate_now_and_then();
  note_calm(dt);
}

bool LiveScene::Contents::are_nodes_led(const Conditions& after, const VectorX& targets) const {
  const Dependents* dependents = world.dependents();
  if (dependents == nullptr) return targets != state.positions;
  VectorX others = targets, before = VectorX::Zero(targets.size()), now = before;
  for (const Dependents::Relation& relation : dependents->relations())
    others[relation.unknown] = state.positions[relation.unknown];
  set_constants(world, this->conditions(), before);
  set_constants(world, after, now);
  return others != state.positions || before != now;
}

/// Once nobody pulls, steps are longer that start with a body that had cells inside out, and not all of them
/// at a tenth of their volume again; not before anybody has laid hand on what a run has left. Cells that are
/// flat and have never been inside out move as their law says.
void LiveScene::Contents::count_mending_steps() {
  const bool is_folded = !held && !is_as_run && std::ranges::any_of(fold_barriers, [](const auto& barrier) {
    return barrier && barrier->is_resting();
  });
  mending_steps = is_folded ? mending_steps + 1 : std::max(0, mending_steps - 1);
}

/// Backward Euler dissipates the more the longer its step. Each counts as four times as long as the one
/// before: up to statics where the bodies are held, and no longer than a free body takes to fall a little.
double LiveScene::Contents::mending_factor() const {
  if (mending_steps == 0) return 1;
  const double g = controls.gravity.norm();
  const bool may_fall = g > 0 && std::ranges::find(is_fixed, std::uint8_t{1}) == is_fixed.end();
  const double longest = may_fall ? std::sqrt(fall_while_mending * extent / g) : longest_mending_step;
  return std::clamp(std::pow(4.0, mending_steps), 1.0, std::max(1.0, longest / controls.time_step));
}

/// One step of the proximal point method: the mass matrix, divided by a scale that grows, keeps the system
/// definite while velocities are no longer carried along.
void LiveScene::Contents::move_to_equilibrium(const StepBudget& budget) {
  const double dt = controls.time_step;
  const Conditions conditions = this->conditions();
  const StagePlan plan = plan_stage(world, conditions,
                                    {.base_positions = state.positions,
                                     .base_velocities = VectorX::Zero(state.positions.size()),
                                     .duration = dt * std::pow(10.0, 0.5 * std::min(calm.seeking_steps, 8)),
                                     .shape = state.positions},
                                    state.positions);
  const Terms all = with_hand(terms_at_rest);
  Potential potential(all, is_fixed, conditions, plan.stage, {}, state.history, world.dependents());
  VectorX x = state.positions;
  NewtonReport newton_report =
      minimize(potential, {.places = x}, plan.targets, 0.1 * rest_tolerance, budget, x);
  const Potential at_rest(all, is_fixed, conditions, static_stage(state.positions), {}, state.history,
                          world.dependents());
  VectorX gradient;
  at_rest.gradient(x, gradient);
  Convergence balance(at_rest, is_fixed, newton.parts(), rest_tolerance, unloaded_scale());
  balance.measure(x, gradient);
  const bool is_at_rest = balance.verdict({}, /*look_closer=*/true) == Convergence::Verdict::yes;
  newton_report.residual = balance.residual();
  newton_report.force_scale = balance.force_scale();
  newton_report.worst_unknown = balance.worst_unknown();
  state.positions = std::move(x);
  state.velocities.setZero();
  mending_steps = 0;
  ++state.step;
  ++calm.seeking_steps;
  measure(newton_report);
  report.at_rest = report.converged = is_at_rest;
  if (is_at_rest) report.discretisation_errors = discretisation_errors(world, state.positions);
  say();
}

double LiveScene::Contents::unloaded_scale() const {
  return unloaded_force_scale * controls.youngs_modulus * std::pow(extent, world.dimension - 1);
}

/// The error by the size of the cells, where the state tells it; else what was found before stays.
void LiveScene::Contents::estimate_now_and_then() {
  if (state.step % steps_between_estimates != steps_to_first_estimate) return;
  if (report.elastic_energy < least_share_of_strain_energy * report.kinetic_energy) return;
  report.discretisation_errors = discretisation_errors(world, state.positions);
  say();
}

/// Whether anything moved in the last step.
void LiveScene::Contents::note_calm(double dt) {
  const double moved = (state.positions - state.previous_positions).cwiseAbs().maxCoeff();
  const bool is_quiet = moved <= quiet_speed * extent * dt && report.inverted_cells == 0;
  calm.quiet_steps = is_quiet ? calm.quiet_steps + 1 : 0;
}

}  // namespace resilin
