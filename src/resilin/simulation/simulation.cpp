#include "resilin/simulation/simulation.hpp"

#include <chrono>
#include <cmath>

#include "resilin/core/error.hpp"
#include "resilin/simulation/load_control.hpp"
#include "resilin/simulation/potential.hpp"

namespace resilin {

Simulation::Simulation(World world)
    : world_(std::move(world)),
      integrator_(world_.is_dynamic
                      ? make_integrator(world_.integrator, world_.place + ": simulation.integrator")
                      : nullptr),
      newton_(world_.dimension, world_.pattern,
              make_linear_solver({.kind = world_.solver.kind,
                                  .is_dynamic = world_.is_dynamic,
                                  .max_iterations = world_.solver.max_iterations},
                                 world_.num_free_unknowns())) {
  state_.positions = world_.start_positions;
  state_.velocities =
      world_.is_dynamic ? world_.start_velocities : VectorX::Zero(world_.start_positions.size());
  state_.load = world_.is_dynamic ? 1 : 0;
  state_.load_increment = 1.0 / world_.load_steps;
  state_.previous_positions = state_.positions;
  frame_ = measure_frame(world_, state_, nullptr);
}

bool Simulation::is_finished() const {
  if (world_.is_dynamic) return state_.time >= world_.end_time - 1e-9 * world_.time_step;
  return state_.load >= 1;
}

int Simulation::expected_steps() const {
  if (world_.is_dynamic) return static_cast<int>(std::ceil(world_.end_time / world_.time_step - 1e-9));
  return state_.step + static_cast<int>(std::ceil((1 - state_.load) / state_.load_increment - 1e-9));
}

StepReport Simulation::step(const NewtonObserver& observer) {
  const auto start = std::chrono::steady_clock::now();
  const int step_before = state_.step;
  StepReport report =
      world_.is_dynamic ? step_in_time(observer) : step_in_load(world_, newton_, state_, observer);
  if (!world_.is_dynamic && state_.step > step_before) frame_ = measure_frame(world_, state_, nullptr);
  timing_.assembly += report.newton.assembly_seconds;
  timing_.solve += report.newton.solve_seconds;
  timing_.steps += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (report.status == StepReport::Status::interrupted) return report;  // state and frame are those before
  frame_.newton_iterations = report.newton.iterations;
  frame_.linear_iterations = report.newton.linear_iterations;
  frame_.residual = report.newton.relative_residual();
  frame_.residual_newton = report.newton.residual;
  frame_.converged = report.status == StepReport::Status::converged;
  return report;
}

StepReport Simulation::step_in_time(const NewtonObserver& observer) {
  StepReport report;
  const Motion start{.positions = state_.positions, .velocities = state_.velocities};
  std::vector<VectorX> solutions;
  VectorX gradient;
  for (int i = 0; i < integrator_->num_stages(); ++i) {
    const Stage stage = integrator_->begin_stage(i, start, solutions, world_.time_step);
    const Conditions conditions{.time = state_.time + stage.time_fraction * world_.time_step, .load = 1};
    const Inertia inertia(world_.mass, stage.target, stage.scale);
    const Potential potential(world_, conditions, &inertia);
    VectorX targets = solutions.empty() ? start.positions : solutions.back();
    VectorX x = targets;
    place_supports(world_.dimension, world_.supports, world_.rest_positions, conditions, targets);
    const VectorX held = x;
    choose_lower_start(potential, world_.is_fixed, held, stage.target, x);
    const NewtonReport newton =
        newton_.minimize(potential, world_.is_fixed, targets, newton_settings(world_), x, observer);
    add_to(report.newton, newton);
    if (newton.status == NewtonReport::Status::interrupted) {
      report.status = StepReport::Status::interrupted;
      return report;
    }
    if (!newton.converged()) {
      report.status = StepReport::Status::not_converged;
      report.reason = describe_failure(world_, newton, x);
    }
    potential.gradient(x, gradient);
    solutions.push_back(std::move(x));
  }
  Motion end = integrator_->finish(start, solutions, world_.time_step);
  state_.positions = std::move(end.positions);
  state_.velocities = std::move(end.velocities);
  ++state_.step;
  state_.time = state_.step * world_.time_step;
  frame_ = measure_frame(world_, state_, &gradient);
  return report;
}

void Simulation::resume_from(const State& state, const std::string& place) {
  if (state.positions.size() != state_.positions.size() ||
      state.velocities.size() != state_.velocities.size()) {
    throw InputError(place, "a checkpoint with " + std::to_string(state_.positions.size()) + " unknowns",
                     std::to_string(state.positions.size()),
                     "the scene was changed: run again without --resume");
  }
  state_ = state;
  frame_ = measure_frame(world_, state_, nullptr);
}

}  // namespace resilin
