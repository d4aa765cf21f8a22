#include "resilin/simulation/step.hpp"

#include <algorithm>
#include <cmath>

#include "resilin/simulation/stage_solver.hpp"

namespace resilin {

void add_to(NewtonReport& sum, const NewtonReport& part) {
  NewtonReport total = part;
  total.iterations += sum.iterations;
  total.linear_solves += sum.linear_solves;
  total.linear_iterations += sum.linear_iterations;
  total.line_search_halvings += sum.line_search_halvings;
  total.tangent_iterations += sum.tangent_iterations;
  total.projected_solves += sum.projected_solves;
  total.lag_rounds += sum.lag_rounds;
  total.assembly_seconds += sum.assembly_seconds;
  total.solve_seconds += sum.solve_seconds;
  sum = total;
}

void take_counts(const NewtonReport& sum, NewtonReport& report) {
  NewtonReport others = report;
  report = sum;
  others.iterations = others.linear_solves = others.linear_iterations = others.line_search_halvings = 0;
  others.tangent_iterations = others.projected_solves = others.lag_rounds = 0;
  others.assembly_seconds = others.solve_seconds = 0;
  add_to(report, others);
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
  const VectorX way = candidate - x;
  objective.prepare(x, way);
  const double difference = objective.difference(x, candidate);
  if (!std::isfinite(difference) || !(difference < 0) || objective.max_step(x, way) != 1) return false;
  x = candidate;
  return true;
}

}  // namespace resilin
