#include "resilin/simulation/step.hpp"

#include <cmath>

#include "resilin/core/text.hpp"
#include "resilin/mesh/facet.hpp"

namespace resilin {

void add_to(NewtonReport& sum, const NewtonReport& part) {
  NewtonReport total = part;
  total.iterations += sum.iterations;
  total.linear_solves += sum.linear_solves;
  total.linear_iterations += sum.linear_iterations;
  total.line_search_halvings += sum.line_search_halvings;
  total.tangent_iterations += sum.tangent_iterations;
  total.projected_solves += sum.projected_solves;
  total.assembly_seconds += sum.assembly_seconds;
  total.solve_seconds += sum.solve_seconds;
  sum = total;
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

void choose_lower_start(Objective& objective, std::span<const std::uint8_t> is_fixed, const VectorX& held,
                        VectorX candidate, VectorX& x) {
  for (Eigen::Index k = 0; k < x.size(); ++k) {
    if (is_fixed[static_cast<std::size_t>(k)] != 0) candidate[k] = held[k];
  }
  const VectorX way = candidate - x;
  objective.prepare(x, way);
  const double difference = objective.difference(x, candidate);
  if (std::isfinite(difference) && difference < 0 && objective.max_step(x, way) == 1) x = candidate;
}

std::string describe_failure(const World& world, const NewtonReport& report, const VectorX& positions) {
  std::string text = report.reason;
  if (report.worst_unknown >= 0) {
    const Index node = report.worst_unknown / world.dimension;
    const Body& body = world.body_of(node);
    const Vector3 X = world.place_of(node, world.rest_positions);
    text += "; the force residual is " + format_number(report.residual) + " N (" +
            format_number(report.relative_residual()) + " of the load), largest at vertex " +
            std::to_string(node - body.first_node) + " of \"" + body.name + "\" at (" + format_number(X.x()) +
            ", " + format_number(X.y()) + ", " + format_number(X.z()) + ")";
  }
  for (const Body& body : world.bodies) {
    const auto [ratio, cell] = body.elastic->min_volume_ratio(positions);
    if (ratio > 0.05) continue;
    text += "; cell " + std::to_string(cell) + " of \"" + body.name + "\" has volume ratio " +
            format_number(ratio);
  }
  return text;
}

}  // namespace resilin
