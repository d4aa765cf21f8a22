#include "resilin/simulation/simulation.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <span>

#include "resilin/core/error.hpp"
#include "resilin/core/text.hpp"
#include "resilin/energy/facet.hpp"
#include "resilin/simulation/potential.hpp"

namespace resilin {
namespace {

constexpr double smallest_load_increment = 1e-4;
constexpr double load_growth = 1.5;
constexpr int quick_convergence = 5;  ///< Newton iterations below which the load increment grows

void add_to(NewtonReport& sum, const NewtonReport& part) {
  NewtonReport total = part;
  total.iterations += sum.iterations;
  total.linear_solves += sum.linear_solves;
  total.linear_iterations += sum.linear_iterations;
  total.line_search_halvings += sum.line_search_halvings;
  total.projected_solves += sum.projected_solves;
  total.assembly_seconds += sum.assembly_seconds;
  total.solve_seconds += sum.solve_seconds;
  sum = total;
}

/// The one of two starts with the lower objective, so that a step cut short never has pumped energy in.
/// At fixed unknowns the candidate takes the values of `held`.
void choose_lower_start(const Objective& objective, std::span<const std::uint8_t> is_fixed,
                        const VectorX& held, VectorX candidate, VectorX& x) {
  for (Eigen::Index k = 0; k < x.size(); ++k) {
    if (is_fixed[static_cast<std::size_t>(k)] != 0) candidate[k] = held[k];
  }
  const double difference = objective.difference(x, candidate);
  if (std::isfinite(difference) && difference < 0 && objective.max_step(x, candidate - x) == 1) x = candidate;
}

}  // namespace

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

NewtonSettings Simulation::newton_settings() const {
  NewtonSettings settings;
  settings.tolerance = world_.newton.tolerance;
  settings.max_iterations = world_.newton.max_iterations;
  const std::string& policy = world_.newton.projection;
  if (policy == "none") {
    settings.projection = ProjectionPolicy::none;
  } else if (policy == "clamp") {
    settings.projection = ProjectionPolicy::clamp;
  } else if (policy == "absolute") {
    settings.projection = ProjectionPolicy::absolute;
  } else {
    settings.projection = world_.is_dynamic ? ProjectionPolicy::on_failure : ProjectionPolicy::adaptive;
  }
  return settings;
}

StepReport Simulation::step(const NewtonObserver& observer) {
  const auto start = std::chrono::steady_clock::now();
  StepReport report = world_.is_dynamic ? step_in_time(observer) : step_in_load(observer);
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
        newton_.minimize(potential, world_.is_fixed, targets, newton_settings(), x, observer);
    add_to(report.newton, newton);
    if (newton.status == NewtonReport::Status::interrupted) {
      report.status = StepReport::Status::interrupted;
      return report;
    }
    if (!newton.converged()) {
      report.status = StepReport::Status::not_converged;
      report.reason = describe_failure(newton, x);
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

StepReport Simulation::step_in_load(const NewtonObserver& observer) {
  StepReport report;
  while (true) {
    double load = state_.load + state_.load_increment;
    if (load > 1 - 1e-9) load = 1;
    const Conditions conditions{.time = 0, .load = load};
    const Potential potential(world_, conditions, nullptr);
    VectorX targets = state_.positions;
    place_supports(world_.dimension, world_.supports, world_.rest_positions, conditions, targets);
    VectorX x = state_.positions;
    if (state_.load > state_.previous_load) {
      const double ratio = (load - state_.load) / (state_.load - state_.previous_load);
      const VectorX guess = x + ratio * (x - state_.previous_positions);
      choose_lower_start(potential, world_.is_fixed, targets, guess, x);
    }
    const NewtonReport newton =
        newton_.minimize(potential, world_.is_fixed, targets, newton_settings(), x, observer);
    add_to(report.newton, newton);
    if (newton.status == NewtonReport::Status::interrupted) {
      report.status = StepReport::Status::interrupted;
      return report;
    }
    if (newton.converged()) {
      state_.previous_positions = std::move(state_.positions);
      state_.previous_load = state_.load;
      state_.positions = std::move(x);
      state_.load = load;
      ++state_.step;
      if (newton.iterations < quick_convergence) {
        state_.load_increment = std::min(load_growth * state_.load_increment, 1.0 / world_.load_steps);
      }
      frame_ = measure_frame(world_, state_, nullptr);
      return report;
    }
    ++report.failed_attempts;
    state_.load_increment = 0.5 * (load - state_.load);
    if (state_.load_increment < smallest_load_increment) {
      report.status = StepReport::Status::not_converged;
      report.reason = "no equilibrium was found beyond load factor " + format_number(state_.load) + ": " +
                      describe_failure(newton, x);
      return report;
    }
  }
}

std::string Simulation::describe_failure(const NewtonReport& report, const VectorX& positions) const {
  std::string text = report.reason;
  if (report.worst_unknown >= 0) {
    const Index node = report.worst_unknown / world_.dimension;
    const Body& body = world_.body_of(node);
    const Vector3 X = node_position(world_.dimension, node, world_.rest_positions);
    text += "; the force residual is " + format_number(report.residual) + " N (" +
            format_number(report.relative_residual()) + " of the load), largest at vertex " +
            std::to_string(node - body.first_node) + " of \"" + body.name + "\" at (" + format_number(X.x()) +
            ", " + format_number(X.y()) + ", " + format_number(X.z()) + ")";
  }
  for (const Body& body : world_.bodies) {
    const auto [ratio, cell] = body.elastic->min_volume_ratio(positions);
    if (ratio > 0.05) continue;
    text += "; cell " + std::to_string(cell) + " of \"" + body.name + "\" has volume ratio " +
            format_number(ratio);
  }
  return text;
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
