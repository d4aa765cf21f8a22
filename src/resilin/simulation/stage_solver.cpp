#include "resilin/simulation/stage_solver.hpp"

#include <algorithm>
#include <chrono>

#include "resilin/linear/dependents.hpp"
#include "resilin/optimize/convergence.hpp"
#include "resilin/simulation/rigid_fit.hpp"
#include "resilin/simulation/step.hpp"

namespace resilin {
namespace {

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

/// Makes x the bodies in a shape that they may have, moved as rigid ones to where they fly, if that lowers
/// the potential. @return whether it did
bool fit_to_flight(Potential& potential, std::span<const std::uint8_t> is_fixed, const Flight& flight,
                   const VectorX& shape, VectorX& x) {
  if (flight.world == nullptr || potential.dependents() != nullptr) return false;
  const VectorX held = x;
  VectorX fitted = rigidly_fitted(*flight.world, is_fixed, shape, flight.places, x);
  const ProcessGroup& share = flight.world->share;
  if (share.all(fitted == x)) return false;  // no body is free
  if (choose_lower_start(potential, is_fixed, held, fitted, x)) return true;
  // Contact of one body is no reason against the flight of others.
  if (flight.world->bodies.size() == 1) return false;
  const VectorX touched = potential.gradient_of(EnergyCategory::contact, x).cwiseAbs() +
                          potential.gradient_of(EnergyCategory::contact, fitted).cwiseAbs();
  for (const Body& body : flight.world->bodies) {
    const Eigen::Index dim = flight.world->dimension;
    const Eigen::Index first = body.first_node * dim, count = body.num_nodes * dim;
    if (share.any(!touched.segment(first, count).isZero(0)))
      fitted.segment(first, count) = x.segment(first, count);
  }
  return choose_lower_start(potential, is_fixed, held, fitted, x);
}

/// The residual of a search at another place than where it ended.
void measure_again(const Potential& potential, std::span<const std::uint8_t> is_fixed, const Newton& newton,
                   const VectorX& x, NewtonReport& report) {
  VectorX gradient;
  potential.gradient(x, gradient);
  Convergence balance(potential, is_fixed, newton.parts(), /*tolerance=*/0);
  balance.measure(x, gradient);
  report.residual = balance.residual();
  report.force_scale = balance.force_scale();
  report.worst_unknown = balance.worst_unknown();
}

}  // namespace

Flight flight(const World& world, std::span<const std::uint8_t> is_fixed, const Potential& potential,
              const Stage& stage, const Vector3& gravity, const VectorX& x) {
  Flight flight{.places = stage.target(), .world = &world};
  const Eigen::Index dim = world.dimension;
  const VectorX g = gravity.head(dim);
  if (g.isZero(0)) return flight;
  const VectorX pull =
      potential.gradient_of(EnergyCategory::external, x) + potential.gradient_of(EnergyCategory::contact, x);
  for (const Body& body : world.bodies) {
    VectorX force = VectorX::Zero(dim);
    for (Index node = body.first_node; node < body.first_node + body.num_nodes; ++node)
      if (world.share.owns(node)) force -= pull.segment(node * dim, dim);
    world.share.sum(std::span(force.data(), static_cast<std::size_t>(dim)));
    if (!is_free(world, body, is_fixed) || !(force.dot(g) > 0.5 * body.mass * g.squaredNorm())) continue;
    flight.places.segment(body.first_node * dim, body.num_nodes * dim) +=
        stage.scale() * g.replicate(body.num_nodes, 1);
  }
  return flight;
}

StageReport solve_stage(Potential& potential, std::span<const std::uint8_t> is_fixed, const VectorX& targets,
                        const Flight& flight, const NewtonSettings& settings, const StageBudget& budget,
                        Newton& newton, VectorX& x, const NewtonObserver& observer) {
  const Clock clock(budget, observer);
  const bool may_fly = flight.world != nullptr || flight.places.size() > 0;
  VectorX held = may_fly ? x : VectorX();
  if (may_fly && potential.dependents() != nullptr)  // their constants
    for (const Dependents::Relation& relation : potential.dependents()->relations())
      held[relation.unknown] = targets[relation.unknown];
  StageReport report;
  potential.form_lag(x);
  if (potential.conditions().delay > 0)
    potential.lead_colliders(static_cast<int>(x.size() / newton.parts().num_nodes()), x);
  if (may_fly) report.flew = choose_lower_start(potential, is_fixed, held, flight.places, x);
  NewtonSettings allowed = settings;
  allowed.lag_rounds = budget.friction_rounds;
  allowed.max_iterations = std::min(allowed.max_iterations, budget.iterations);
  NewtonReport& total = report.newton;
  total = newton.minimize(potential, is_fixed, targets, allowed, x, clock.observer());
  // The time may be over with the very iteration that solved the stage.
  if (total.status == NewtonReport::Status::interrupted && clock.is_over() &&
      total.relative_residual() <= settings.tolerance)
    total.status = NewtonReport::Status::converged;
  report.friction_rounds = total.lag_rounds;
  report.friction_mismatch = total.lag_mismatch;
  if (total.converged()) return report;
  bool is_moved = fit_to_flight(potential, is_fixed, flight, x, x);
  is_moved |= fit_to_flight(potential, is_fixed, flight, held, x);
  if (is_moved) measure_again(potential, is_fixed, newton, x, total);
  return report;
}

}  // namespace resilin
