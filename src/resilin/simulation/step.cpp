#include "resilin/simulation/step.hpp"

#include <algorithm>
#include <cmath>

#include "resilin/linear/dependents.hpp"
#include "resilin/simulation/stage_solver.hpp"

namespace resilin {

void add_counts(NewtonReport& sum, const NewtonReport& part) {
  sum.iterations += part.iterations;
  sum.linear_solves += part.linear_solves;
  sum.linear_iterations += part.linear_iterations;
  sum.line_search_halvings += part.line_search_halvings;
  sum.tangent_iterations += part.tangent_iterations;
  sum.projected_solves += part.projected_solves;
  sum.lag_rounds += part.lag_rounds;
  sum.assembly_seconds += part.assembly_seconds;
  sum.solve_seconds += part.solve_seconds;
}

void add_to(NewtonReport& sum, const NewtonReport& part) {
  NewtonReport total = part;
  add_counts(total, sum);
  sum = total;
}

void FrictionReport::add(const StageReport& stage) {
  rounds += stage.friction_rounds;
  if (stage.friction_mismatch == 0) return;
  ++unsettled_stages;
  mismatch = std::max(mismatch, stage.friction_mismatch);
}

void FrictionReport::add(const FrictionReport& part) {
  rounds += part.rounds;
  unsettled_stages += part.unsettled_stages;
  mismatch = std::max(mismatch, part.mismatch);
}

NewtonSettings newton_settings(const World& world) {
  NewtonSettings settings;
  settings.tolerance = world.newton.tolerance;
  settings.max_iterations = world.newton.max_iterations;
  settings.is_quadratic = is_linear(world);
  settings.relaxed_steps = world.is_dynamic ? 0 : 4;
  switch (world.newton.projection) {
    case ProjectionChoice::none:
      settings.projection = ProjectionPolicy::none;
      break;
    case ProjectionChoice::clamp:
      settings.projection = ProjectionPolicy::clamp;
      break;
    case ProjectionChoice::absolute:
      settings.projection = ProjectionPolicy::absolute;
      break;
    case ProjectionChoice::automatic:
      settings.projection = world.is_dynamic ? ProjectionPolicy::on_failure : ProjectionPolicy::adaptive;
  }
  return settings;
}

bool choose_lower_start(Objective& objective, std::span<const std::uint8_t> is_fixed, const VectorX& held,
                        VectorX candidate, VectorX& x) {
  for (Eigen::Index k = 0; k < x.size(); ++k) {
    if (is_fixed[static_cast<std::size_t>(k)] != 0) candidate[k] = held[k];
  }
  if (objective.dependents() != nullptr) objective.dependents()->place(held, candidate);
  const VectorX way = candidate - x;
  objective.prepare(x, way);
  const double difference = objective.difference(x, candidate);
  if (!std::isfinite(difference) || !(difference < 0) || objective.max_step(x, way) != 1) return false;
  x = candidate;
  return true;
}

}  // namespace resilin
