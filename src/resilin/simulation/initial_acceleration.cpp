#include "resilin/simulation/initial_acceleration.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "resilin/energy/time_function.hpp"
#include "resilin/linear/dependents.hpp"
#include "resilin/linear/linear_solver.hpp"
#include "resilin/optimize/residual.hpp"
#include "resilin/simulation/potential.hpp"
#include "resilin/simulation/prescribed_motion.hpp"

namespace resilin {
namespace {

constexpr double mass_tolerance = 1e-14;  ///< mass matrices are well conditioned: this is round-off

/// Solves M a = b over the free unknowns; `a` and `b` are zero at the others.
VectorX solve_with_mass(const World& world, const VectorX& b) {
  const Dependents* dependents = world.dependents();
  BlockMatrix matrix(world.dimension, dependents == nullptr ? world.mass->pattern : world.pattern);
  world.mass->add_to(1, matrix);
  if (dependents != nullptr) dependents->reduce(matrix);
  eliminate(matrix, world.is_fixed);
  const bool is_whole = world.share.is_whole() && dependents == nullptr;
  const auto solver = make_linear_solver({.kind = is_whole ? "cg_jacobi" : "auto", .share = world.share},
                                         world.num_free_unknowns());
  solver->analyze(matrix, world.start_positions);
  solver->factorize(matrix);
  VectorX a = VectorX::Zero(b.size());
  solver->solve(matrix, b, a, mass_tolerance);
  if (dependents != nullptr) dependents->follow(a);
  return a;
}

}  // namespace

Stage stage_at_once(const VectorX& positions, const VectorX& velocities) {
  return {.base_positions = positions - velocities,
          .base_velocities = velocities,
          .duration = 1,
          .shape = positions};
}

Terms smooth_terms(const World& world) {
  Terms smooth;
  std::ranges::copy_if(world.terms, std::back_inserter(smooth), [](const auto& term) {
    const EnergyCategory category = term->properties().category;
    return category != EnergyCategory::inertia && !acts_as_impulse(category);
  });
  return smooth;
}

VectorX accelerations_by(const World& world, const VectorX& forces) {
  VectorX right_side = forces;
  if (world.dependents() != nullptr) world.dependents()->add_forces(right_side);
  set_fixed_to_zero(world.is_fixed, right_side);
  if (!world.mass->is_lumped() || world.dependents() != nullptr) return solve_with_mass(world, right_side);
  VectorX masses = world.mass->nodal;
  world.share.add_copies(masses);
  for (Eigen::Index i = 0; i < right_side.size(); ++i)
    if (right_side[i] != 0) right_side[i] /= masses[i / world.dimension];
  return right_side;
}

VectorX accelerations_at(const World& world, const State& state, const VectorX& prescribed) {
  const Conditions conditions = conditions_of(state);
  const Stage stage = stage_at_once(state.positions, state.velocities);
  const Terms smooth = smooth_terms(world);
  const Potential potential(smooth, world.is_fixed, conditions, stage, world.share, state.history);
  VectorX gradient;
  potential.gradient(state.positions, gradient);
  if (!world.share.all(gradient.allFinite()))
    gradient.setZero();                        // a start outside the domain pulls nowhere in particular
  VectorX a = VectorX::Zero(gradient.size());  // the prescribed part
  for (Eigen::Index i = 0; i < a.size(); ++i)
    if (world.is_fixed[static_cast<std::size_t>(i)] != 0) a[i] = prescribed[i];
  VectorX pull;
  world.mass->multiply(a, pull);
  world.share.add_copies(pull);
  return a + accelerations_by(world, -gradient - pull);
}

bool is_event(const World& world, double time) {
  return std::ranges::any_of(world.event_times,
                             [time](double event) { return std::abs(event - time) <= 2 * time_slack(time); });
}

double time_after(double time, double time_step) {
  return time + 4 * std::max(time_slack(time), time_slack(time_step));
}

VectorX accelerations_from(const World& world, State state, double time_step) {
  state.time = time_after(state.time, time_step);
  const VectorX zero = VectorX::Zero(state.positions.size());
  Motion prescribed{state.positions, zero, zero};
  prescribe_motion_at(world, state.time, prescribed);
  return accelerations_at(world, state, prescribed.accelerations);
}

}  // namespace resilin
