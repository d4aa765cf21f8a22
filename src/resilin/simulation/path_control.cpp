// Steps along the path of equilibria.

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "resilin/core/text.hpp"
#include "resilin/simulation/force_balance.hpp"
#include "resilin/simulation/load_control.hpp"
#include "resilin/simulation/potential.hpp"

namespace resilin {
namespace {

constexpr double smallest_arc = 1e-4;   ///< relative to the first one
constexpr double largest_arc = 4;       ///< the same
constexpr double quick_iterations = 4;  ///< an arc that takes this many is right

/// The loads of a step from the equilibrium `start`.
class StaticLoads final : public LoadFamily {
 public:
  StaticLoads(const World& world, const VectorX& start) : world_(world), stage_(static_stage(start)) {}

  std::unique_ptr<Objective> at(double load) const override {
    return std::make_unique<Potential>(Potential::in_stage(world_, VectorX(), world_.at_load(load), stage_));
  }
  void place_fixed(double load, VectorX& x) const override {
    place_supports(world_.dimension, world_.supports, world_.rest_positions, world_.at_load(load), x);
  }

 private:
  const World& world_;
  Stage stage_;
};

PathSettings path_settings(const World& world, const State& state) {
  return {.tolerance = world.newton.tolerance,
          .max_iterations = std::min(world.newton.max_iterations, 20),
          .arc_length = state.arc_length,
          .load_weight = state.load_weight};
}

/// The arc of a straight path to load factor 1 / load_steps.
double first_arc(const World& world, const State& state) {
  return std::numbers::sqrt2 * state.load_weight / world.load_steps;
}

}  // namespace

std::string LoadControl::begin_path(const World& world, Newton& newton, State& state, StepReport& report,
                                    const NewtonObserver& observer) {
  const StaticLoads family(world, state.positions);
  VectorX targets = state.positions;
  family.place_fixed(0, targets);
  const std::unique_ptr<Objective> unloaded = family.at(0);
  const NewtonReport search =
      newton.minimize(*unloaded, world.is_fixed, targets, newton_settings(world), state.positions, observer);
  add_to(report.newton, search);
  if (search.status == NewtonReport::Status::interrupted) {
    report.status = StepReport::Status::interrupted;
    return search.reason;
  }
  if (!search.converged())
    return "no equilibrium was found at zero load: " + describe_failure(world, search, state.positions);
  VectorX slope;
  if (!follower_->tangent(family, world.is_fixed, {state.positions, 0}, slope))
    return "the stiffness matrix is singular at zero load";
  for (Eigen::Index i = 0; i < slope.size(); ++i) {
    if (world.is_fixed[static_cast<std::size_t>(i)] != 0) slope[i] = 0;
  }
  if (!(slope.norm() > 0)) return "nothing moves under the loads: there is no path to follow";
  state.previous_positions = state.positions;
  state.load_weight = slope.norm();
  state.arc_length = first_arc(world, state);
  return {};
}

StepReport LoadControl::step_along_path(const World& world, Newton& newton, State& state,
                                        const NewtonObserver& observer) {
  StepReport report;
  const auto end_with = [&](StepReport::Status status, const std::string& reason) {
    report.status = status;
    report.reason = reason;
    return report;
  };
  if (state.load_weight == 0) {
    const std::string failure = begin_path(world, newton, state, report, observer);
    if (report.status == StepReport::Status::interrupted) return report;
    if (!failure.empty()) return end_with(StepReport::Status::not_converged, failure);
  }
  const StaticLoads family(world, state.positions);
  while (true) {
    const PathPoint previous{state.previous_positions, state.previous_load};
    PathPoint point{state.positions, state.load};
    NewtonReport search =
        follower_->advance(family, world.is_fixed, path_settings(world, state), previous, point, observer);
    add_to(report.newton, search);
    const int iterations = search.iterations;
    if (search.converged() && point.load > 1) {  // the last point is the one at full load
      const double part = (1 - state.load) / (point.load - state.load);
      point.positions = state.positions + part * (point.positions - state.positions);
      point.load = 1;
      search = follower_->settle(family, world.is_fixed, path_settings(world, state), point, observer);
      add_to(report.newton, search);
    }
    if (search.status == NewtonReport::Status::interrupted) {
      report.status = StepReport::Status::interrupted;
      return report;
    }
    std::string imbalance;
    if (search.converged()) {
      const Potential potential = Potential::at(world, world.at_load(point.load), state.positions);
      VectorX gradient;
      potential.gradient(point.positions, gradient);
      imbalance = describe_imbalance(world, potential, point.positions, gradient, search,
                                     point.positions - world.rest_positions);
    }
    const bool turns_too_far = largest_turn(world, world.at_load(state.load), world.at_load(point.load)) >
                               largest_turn_of_step * (1 + 1e-9);
    if (search.converged() && imbalance.empty() && !turns_too_far) {
      state.previous_positions = std::exchange(state.positions, std::move(point.positions));
      state.previous_load = std::exchange(state.load, point.load);
      ++state.step;
      const double factor = std::clamp(std::sqrt(quick_iterations / std::max(iterations, 1)), 0.5, 1.5);
      state.arc_length = std::min(factor * state.arc_length, largest_arc * first_arc(world, state));
      return report;
    }
    ++report.failed_attempts;
    state.arc_length *= 0.5;
    if (!(state.arc_length > smallest_arc * first_arc(world, state))) {
      return end_with(StepReport::Status::not_converged,
                      "the path of equilibria could not be followed beyond load factor " +
                          format_number(state.load) + ": " +
                          (imbalance.empty() ? describe_failure(world, search, point.positions) : imbalance));
    }
  }
}

}  // namespace resilin
