#include "resilin/simulation/step_attempt.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "resilin/simulation/energy_guard.hpp"
#include "resilin/simulation/potential.hpp"

namespace resilin {
namespace {

/// Energy that damping takes on the way to `end` [J].
double dissipation(const World& world, const State& state, const Motion& end, double time_step) {
  double sum = 0;
  for (const auto& term : world.terms) sum += term->dissipation(state.positions, end.positions, time_step);
  return world.share.sum(sum);
}

/// The remedies of each flaw. Steps that are short of iterations on purpose are as good as they get.
Remedies remedies_of(Flaw flaw) {
  switch (flaw) {
    case Flaw::not_found:
      return {.shorter_step = true, .parts = true, .backward_euler = true};
    case Flaw::cut_short:
      return {.shorter_step = false, .parts = false, .backward_euler = true};
    case Flaw::out_of_balance:
      return {.shorter_step = true, .parts = false, .backward_euler = true};
    case Flaw::unsettled_friction:  // where it may settle, `is_lost` has it taken in parts, too
      return {.shorter_step = true, .parts = false, .backward_euler = false};
    case Flaw::blocked:
      return {.shorter_step = true, .parts = false, .backward_euler = true};
    case Flaw::leaves_domain:  // already by backward Euler
      return {.shorter_step = true, .parts = false, .backward_euler = false};
  }
  return {};
}

constexpr double infinity = std::numeric_limits<double>::infinity();

/// Part of the largest kinetic energy by which the energy may rise: schemes keep it only on average. Half
/// of what tests/simulation/energy_test.cpp allows.
constexpr double energy_tolerance = 5e-4;

}  // namespace

History history_of(const State& state) {
  return {.now = {state.positions, state.velocities, state.accelerations},
          .previous_positions = state.previous_positions,
          .previous_velocities = state.previous_velocities,
          .previous_time_step = state.previous_time_step};
}

void TimeStepper::Attempt::add(Flaw flaw, std::string reason, bool began_in_flight) {
  const Remedies more = remedies_of(flaw);
  remedies.shorter_step |= more.shorter_step;
  remedies.parts |= more.parts;
  remedies.backward_euler |= more.backward_euler && !began_in_flight;
  report.status = StepReport::Status::not_converged;
  report.reason = std::move(reason);
  report.has_solution = !remedies.parts;
}

bool TimeStepper::Attempt::keeps_energy(const World& world, const State& start, double time_step,
                                        double round_off, bool is_last_resort) {
  const Conditions after = conditions_after(start, time_step, collider_delay);
  EnergyChange change = energy_change(world, start, end, after);
  change.added += history_heat;
  const double before = std::max(start.largest_kinetic_energy, change.kinetic_before);
  // A scheme may regain the energy that it lost where nothing disturbed it.
  const double least = converged() && !touches && !change.is_driven ? -infinity : 0;
  const double found = std::max(least, start.energy_excess) + change.added;
  // The residual of Newton's method does work, too.
  const double left =
      converged() ? report.newton.residual * world.share.norm(end.positions - start.positions) : 0;
  const double kinetic_without = std::max(before, change.kinetic_after - std::max(0.0, found));
  const double allowed = energy_tolerance * kinetic_without + left + round_off;
  energy_excess = std::max(least, found);
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

void TimeStepper::Attempt::move(const World& world, State& state, double time_step, double time) && {
  if (!stages) return;  // nothing was solved
  state.dissipated_energy += dissipation(world, state, end, time_step);
  state.history = std::move(history);
  state.dissipated_energy += history_heat;
  state.time = time;
  state.collider_delay = collider_delay;
  state.friction_work += friction_work;
  state.dissipated_energy += friction_work;
  History next = stages->after(std::move(end), slowing);
  state.positions = std::move(next.now.positions);
  state.velocities = std::move(next.now.velocities);
  state.accelerations = std::move(next.now.accelerations);
  state.previous_positions = std::move(next.previous_positions);
  state.previous_velocities = std::move(next.previous_velocities);
  state.previous_time_step = time_step;
  state.energy_excess = energy_excess;
  state.largest_kinetic_energy = largest_kinetic_energy;
  if (is_guarded()) ++state.guarded_steps;
  state.removed_energy += report.removed_energy;
  ++state.step;
}

}  // namespace resilin
