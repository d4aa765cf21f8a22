#include "resilin/simulation/simulation.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "resilin/core/error.hpp"
#include "resilin/core/text.hpp"
#include "resilin/simulation/force_balance.hpp"
#include "resilin/simulation/initial_acceleration.hpp"
#include "resilin/simulation/potential.hpp"
#include "resilin/world/friction.hpp"
#include "resilin/world/support_phase.hpp"

namespace resilin {
namespace {

void check_most_strained(const MostStrained& strained, const World& world, const std::string& place) {
  const Eigen::Index size = strained.positions.size(), num_unknowns = world.rest_positions.size();
  const SmallestVolume& smallest = strained.smallest_volume;
  if (smallest.body < 0 || smallest.body >= static_cast<int>(world.bodies.size()) ||
      std::isnan(smallest.ratio))
    throw InputError(place, "a smallest volume ratio in a body of this scene",
                     format_number(smallest.ratio) + " in body " + std::to_string(smallest.body),
                     "run again without --resume");
  if (strained.energy >= 0 && std::isfinite(strained.energy) && strained.positions.allFinite() &&
      (size == num_unknowns || (size == 0 && strained.energy == 0)))
    return;
  throw InputError(place, "a most strained state of " + std::to_string(num_unknowns) + " DOFs",
                   "one of " + std::to_string(size) + " with " + format_number(strained.energy) + " J",
                   "run again without --resume");
}

/// Rigid bodies are so much stiffer than others that conjugate gradients find no direction.
std::string solver_of(const World& world) {
  constexpr Index most_unknowns_direct = 50000;  // a factor of about 1 GB
  const bool has_rigid =
      std::ranges::any_of(world.bodies, [](const Body& body) { return body.rigid != nullptr; });
  if (world.solver.kind != "auto" || !has_rigid || !world.share.is_whole() ||
      world.num_free_unknowns() > most_unknowns_direct)
    return world.solver.kind;
  const std::vector<std::string> names = linear_solver_names();
  return std::ranges::find(names, "multifrontal") != names.end() ? "multifrontal" : "ldlt";
}

}  // namespace

Simulation::Simulation(World world, std::shared_ptr<AnalysisCache> analyses)
    : world_(std::move(world)),
      newton_(world_.dimension, world_.pattern,
              make_linear_solver({.kind = solver_of(world_),
                                  .is_dynamic = world_.is_dynamic,
                                  .max_iterations = world_.solver.max_iterations,
                                  .analyses = std::move(analyses),
                                  .share = world_.share},
                                 world_.num_free_unknowns()),
              world_.share) {
  state_.positions = world_.start_positions;
  state_.velocities =
      world_.is_dynamic ? world_.start_velocities : VectorX::Zero(world_.start_positions.size());
  state_.load = world_.is_dynamic ? 1 : 0;
  state_.previous_positions = state_.positions;
  state_.history = start_of_history(world_.terms, state_.positions);
  state_.phase = phase_at(world_, 0);
  enter_phase(world_, state_.phase, {}, {});
  if (world_.is_dynamic) {
    time_stepper_.emplace(world_);
    time_stepper_->prepare(world_, state_);
  } else {
    load_control_.emplace(world_);
    load_control_->prepare(world_, state_);
  }
  measure(nullptr);
}

bool Simulation::is_finished() const {
  if (world_.modes) return state_.mode >= world_.modes->count;
  if (world_.adaptive && world_.is_dynamic) return state_.time >= world_.end_time;
  if (world_.is_dynamic) return state_.time >= world_.end_time - 1e-9 * world_.time_step;
  return LoadControl::is_finished(world_, state_);
}

double Simulation::share_done() const {
  if (world_.is_dynamic) return std::min(1.0, state_.time / world_.end_time);
  if (!world_.modes) return state_.load;
  return static_cast<double>(state_.mode) / world_.modes->count;
}

/// The frame of the present state.
void Simulation::measure(const VectorX* step_gradient) {
  frame_ = measure_frame(world_, state_, step_gradient);
  if (world_.is_dynamic) most_strained_.note(frame_, state_);
  if (state_.mode == 0) return most_strained_.smallest_volume.note(frame_);
  const VibrationMode& mode = modes_[static_cast<std::size_t>(state_.mode - 1)];
  frame_.mode = {.number = state_.mode,
                 .frequency = mode.frequency(),
                 .is_rigid = mode.is_rigid,
                 .is_unstable = mode.is_unstable(),
                 .growth_rate = mode.is_unstable() ? std::sqrt(-mode.eigenvalue) : 0,
                 .effective_mass = mode.effective_mass};
}

StepReport Simulation::step_to_next_mode(const NewtonObserver& observer) {
  StepReport report;
  if (state_.mode == 0) state_.previous_positions = state_.positions;  // the equilibrium
  if (modes_.empty()) {
    const auto is_stopped = [&] { return observer && !observer(report.newton); };
    modes_ = find_modes(world_, state_.previous_positions, state_.load, report, is_stopped);
    if (report.status != StepReport::Status::converged) return report;
  }
  state_.positions =
      drawn_mode(world_, state_.previous_positions, modes_[static_cast<std::size_t>(state_.mode)]);
  ++state_.mode;
  ++state_.step;
  return report;
}

bool Simulation::shows_modes() const {
  return world_.modes && (!world_.modes->is_loaded || state_.load >= 1);
}

int Simulation::expected_steps() const {
  if (world_.modes && shows_modes()) return state_.step + world_.modes->count - state_.mode;
  if (world_.is_dynamic) {
    const double left = world_.end_time - state_.time;
    const double length = world_.adaptive ? state_.time_step : world_.time_step;
    // No more than fit the counter; equal steps end less than a step behind the end.
    return state_.step + static_cast<int>(std::clamp(std::ceil(left / length - 1e-9), 0.0, 1e9));
  }
  return LoadControl::expected_steps(world_, state_);
}

std::string Simulation::switch_supports_now() {
  const int phase = phase_at(world_, state_.time);
  if (phase <= state_.phase) return "";
  VectorX gradient;
  if (!world_.is_dynamic) {
    const Potential potential = Potential::at(world_, state_);
    potential.gradient(state_.positions, gradient);
    add_friction_forces(world_, state_, gradient);
    // Forces that are only rounding could not fade: a search would have no digits to balance them.
    drop_rounding(world_, potential, state_.positions, gradient);
  }
  const auto energy = [this] {
    VectorX momentum;
    world_.mass->multiply(state_.velocities, momentum);
    const bool has_layers = world_.is_dynamic && !world_.contact_of_phases.empty();
    return world_.share.sum(0.5 * momentum.dot(state_.velocities)) +
           (has_layers ? world_.contact->value(state_.positions, conditions_of(state_)) : 0);
  };
  const double before = energy();
  const std::string overlap = switch_supports(world_, state_, phase, gradient);
  if (!overlap.empty())
    return "contact cannot begin in the step after \"" + step_name_at(world_, state_.time) +
           "\": " + overlap + "; bring them apart in a step before";
  // A support that takes hold stops its vertices; contact that ends drops the energy of its layers.
  state_.dissipated_energy += before - energy();
  if (world_.is_dynamic && state_.accelerations.size() > 0)
    state_.accelerations = accelerations_from(world_, state_, world_.time_step);
  return "";
}

StepReport Simulation::step(const NewtonObserver& observer) {
  const auto start = std::chrono::steady_clock::now();
  StepReport report;
  report.reason = switch_supports_now();
  if (!report.reason.empty()) {
    report.status = StepReport::Status::not_converged;
    report.has_solution = false;
    return report;
  }
  const int step_before = state_.step;
  VectorX gradient;
  if (time_stepper_) {
    report = time_stepper_->step(world_, newton_, state_, gradient, observer);
  } else if (load_control_ && !shows_modes()) {
    report = load_control_->step(world_, newton_, state_, observer);
  } else {
    report = step_to_next_mode(observer);
  }
  if (state_.step > step_before) {
    measure(time_stepper_ ? &gradient : nullptr);
    if (report.friction.unsettled_stages > 0) ++state_.unsettled_steps;
    state_.friction_mismatch = std::max(state_.friction_mismatch, report.friction.mismatch);
    failed_steps_.in_a_row = report.has_solution ? 0 : failed_steps_.in_a_row + 1;
    if (report.status == StepReport::Status::not_converged) note_failure(report.reason);
  }
  timing_.assembly += report.newton.assembly_seconds;
  timing_.solve += report.newton.solve_seconds;
  timing_.steps += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (report.status == StepReport::Status::interrupted) return report;  // state and frame are those before
  frame_.newton_iterations = report.newton.iterations;
  frame_.linear_iterations = report.newton.linear_iterations;
  frame_.residual = report.newton.relative_residual();
  frame_.residual_newton = report.newton.residual;
  frame_.failed_attempts = report.failed_attempts;
  frame_.time_step = report.time_step;
  frame_.time_error = report.time_error;
  frame_.converged = report.status == StepReport::Status::converged;
  frame_.unstable_modes = report.unstable_modes;
  frame_.jump_energy = report.jump_energy;
  frame_.inversion = report.inversion;
  return report;
}

void Simulation::note_failure(const std::string& reason) {
  if (failed_steps_.count++ > 0) return;
  failed_steps_.first_step = state_.step;
  failed_steps_.first_time = state_.time;
  failed_steps_.first_reason = reason;
}

void Simulation::resume_from(const State& state, const std::string& place, const FailedSteps& failed,
                             const MostStrained& most_strained) {
  check_state(state, state_.positions.size(), world_.num_history_values(), place);
  check_most_strained(most_strained, world_, place);
  const int most_modes = world_.modes ? world_.modes->count : 0;
  if (state.mode > most_modes)
    throw InputError(place, "a mode from 0 to " + std::to_string(most_modes), std::to_string(state.mode),
                     "run again without --resume");
  if (state.phase > static_cast<int>(world_.switch_times.size()))
    throw InputError(place, "a phase from 0 to " + std::to_string(world_.switch_times.size()),
                     std::to_string(state.phase), "run again without --resume");
  state_ = state;
  enter_phase(world_, state_.phase, state_.released_forces, state_.support_places);
  if (time_stepper_) time_stepper_->prepare(world_, state_);
  if (state_.mode > 0) {
    StepReport report;
    modes_ = find_modes(world_, state_.previous_positions, state_.load, report, {});
    if (static_cast<int>(modes_.size()) < state_.mode)
      throw InputError(place, "modes of this scene", report.reason);
  }
  most_strained_ = most_strained;
  measure(nullptr);
  if (!std::isfinite(frame_.total_energy()))
    throw InputError(
        place, "a state of finite energy",
        format_number(frame_.total_energy()) + " J: an element is inverted, or a vertex is inside a collider",
        "run again without --resume");
  failed_steps_ = failed;
}

}  // namespace resilin
