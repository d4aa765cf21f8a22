#include "resilin/simulation/stage_solver.hpp"

#include <algorithm>
#include <chrono>

#include "resilin/simulation/step.hpp"

namespace resilin {
namespace {

constexpr int most_advances = 100;
constexpr int iterations_to_give_way = 3;

/// The observer that also looks at the clock.
class Clock {
 public:
  Clock(const StageBudget& budget, const NewtonObserver& observer) : budget_(budget), observer_(observer) {}

  bool is_over() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count() >=
           budget_.seconds;
  }
  NewtonObserver observer() const {
    if (budget_.seconds == std::numeric_limits<double>::infinity()) return observer_;
    return [this](const NewtonReport& report) { return (!observer_ || observer_(report)) && !is_over(); };
  }

 private:
  const StageBudget& budget_;
  const NewtonObserver& observer_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace

VectorX flight_guess(const World& world, std::span<const std::uint8_t> is_fixed, const Potential& potential,
                     const Stage& stage, const Vector3& gravity, const VectorX& x) {
  VectorX guess = stage.target();
  const Eigen::Index dim = world.dimension;
  const VectorX g = gravity.head(dim);
  if (g.isZero(0)) return guess;
  const VectorX pull =
      potential.gradient_of(EnergyCategory::external, x) + potential.gradient_of(EnergyCategory::contact, x);
  const auto is_held = [&](Index node) {
    return world.mass->nodal[node] > 0 &&
           std::ranges::any_of(
               is_fixed.subspan(static_cast<std::size_t>(node * dim), static_cast<std::size_t>(dim)),
               [](std::uint8_t fixed) { return fixed != 0; });
  };
  for (const Body& body : world.bodies) {
    VectorX force = VectorX::Zero(dim);
    bool flies = true;
    for (Index node = body.first_node; node < body.first_node + body.num_nodes && flies; ++node) {
      force -= pull.segment(node * dim, dim);
      flies = !is_held(node);
    }
    if (!flies || !(force.dot(g) > 0.5 * body.mass * g.squaredNorm())) continue;
    guess.segment(body.first_node * dim, body.num_nodes * dim) +=
        stage.scale() * g.replicate(body.num_nodes, 1);
  }
  return guess;
}

NewtonReport solve_stage(Potential& potential, std::span<const std::uint8_t> is_fixed, const VectorX& targets,
                         const VectorX& guess, const NewtonSettings& settings, const StageBudget& budget,
                         Newton& newton, VectorX& x, const NewtonObserver& observer) {
  const Clock clock(budget, observer);
  const VectorX held = x;
  NewtonReport total;
  for (int advance = 0;; ++advance) {
    Conditions conditions = potential.conditions();
    conditions.collider_delay = potential.least_delay(x);
    potential.set_conditions(conditions);
    const bool is_last = conditions.collider_delay == 0 || advance == most_advances;
    if (advance == 0) choose_lower_start(potential, is_fixed, held, guess, x);
    NewtonSettings allowed = settings;
    if (!is_last) allowed.max_iterations = std::min(allowed.max_iterations, iterations_to_give_way);
    add_to(total, newton.minimize(potential, is_fixed, targets, allowed, x, clock.observer()));
    // The time may be over with the very iteration that solved the stage.
    if (total.status == NewtonReport::Status::interrupted && clock.is_over() &&
        total.relative_residual() <= settings.tolerance)
      total.status = NewtonReport::Status::converged;
    const bool is_over = clock.is_over() || total.iterations >= budget.iterations;
    if (is_last || is_over || total.status == NewtonReport::Status::interrupted) return total;
  }
}

}  // namespace resilin
