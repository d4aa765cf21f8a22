#include "resilin/simulation/load_control.hpp"

#include <algorithm>
#include <cmath>

#include "resilin/core/text.hpp"
#include "resilin/simulation/potential.hpp"

namespace resilin {
namespace {

constexpr double smallest_load_increment = 1e-4;
constexpr double load_growth = 1.5;
constexpr int quick_convergence = 5;  ///< Newton iterations below which the load increment grows

/// The load factor of the next attempt. The loads k / load_steps are met exactly, so that a scene gets the
/// frames that it asked for; what is left up to the next of them is shared equally when it takes several
/// steps.
double next_load(const World& world, const State& state) {
  const double asked = std::floor(state.load * world.load_steps + 1e-9) + 1;
  const double next_asked = std::min(asked / world.load_steps, 1.0);
  const double left = next_asked - state.load;
  const double num_steps = std::ceil(left / state.load_increment - 1e-9);
  return num_steps <= 1 ? next_asked : state.load + left / num_steps;
}

/// Where the search for the equilibrium at `load` starts.
VectorX predicted_positions(const World& world, const Objective& potential, const VectorX& targets,
                            const State& state, double load) {
  VectorX x = state.positions;
  if (state.load > state.previous_load) {
    const double ratio = (load - state.load) / (state.load - state.previous_load);
    const VectorX secant = x + ratio * (x - state.previous_positions);
    choose_lower_start(potential, world.is_fixed, targets, secant, x);
  }
  return x;
}

void move_to(State& state, VectorX positions, double load) {
  state.previous_positions = std::move(state.positions);
  state.previous_load = state.load;
  state.positions = std::move(positions);
  state.load = load;
  ++state.step;
}

}  // namespace

StepReport step_in_load(const World& world, Newton& newton, State& state, const NewtonObserver& observer) {
  StepReport report;
  while (true) {
    const double load = next_load(world, state);
    const Conditions conditions{.time = 0, .load = load};
    const Potential potential(world, conditions, nullptr);
    VectorX targets = state.positions;
    place_supports(world.dimension, world.supports, world.rest_positions, conditions, targets);
    VectorX x = predicted_positions(world, potential, targets, state, load);
    const NewtonReport search =
        newton.minimize(potential, world.is_fixed, targets, newton_settings(world), x, observer);
    add_to(report.newton, search);
    if (search.status == NewtonReport::Status::interrupted) {
      report.status = StepReport::Status::interrupted;
      return report;
    }
    if (search.converged()) {
      move_to(state, std::move(x), load);
      if (search.iterations < quick_convergence)
        state.load_increment = std::min(load_growth * state.load_increment, 1.0 / world.load_steps);
      return report;
    }
    ++report.failed_attempts;
    state.load_increment = 0.5 * (load - state.load);
    if (state.load_increment < smallest_load_increment) {
      report.status = StepReport::Status::not_converged;
      report.reason = "no equilibrium was found beyond load factor " + format_number(state.load) + ": " +
                      describe_failure(world, search, x);
      return report;
    }
  }
}

}  // namespace resilin
