#include <algorithm>
#include <limits>
#include <utility>

#include "resilin/core/text.hpp"
#include "resilin/live/live_contents.hpp"
#include "resilin/simulation/oddities.hpp"

namespace resilin {

void LiveScene::Contents::measure(const NewtonReport& newton_report) {
  report.time = state.time;
  report.converged = newton_report.converged();
  report.newton_iterations = newton_report.iterations;
  report.linear_iterations = newton_report.linear_iterations;
  report.residual = newton_report.residual;
  report.relative_residual = newton_report.relative_residual();
  report.assembly_ms = 1e3 * newton_report.assembly_seconds;
  report.solve_ms = 1e3 * newton_report.solve_seconds;
  VectorX momentum;
  world.mass->multiply(state.velocities, momentum);
  report.kinetic_energy = 0.5 * momentum.dot(state.velocities);
  report.elastic_energy = 0;
  report.min_volume_ratio = std::numeric_limits<double>::infinity();
  report.inverted_cells = 0;
  std::size_t number = 0;
  for (const Body& body : world.bodies) {
    report.elastic_energy += body.domains.value(state.positions);
    const double ratio = body.domains.min_volume_ratio(state.positions).ratio;
    report.min_volume_ratio = std::min(report.min_volume_ratio, ratio);
    if (!(ratio > 0)) report.inverted_cells += inverted_cells(body, state.positions).count;
    for (const Domain& domain : body.domains) {
      FoldBarrier* barrier = fold_barriers[number++].get();
      if (barrier == nullptr) continue;
      const double own =
          body.domains.size() == 1 ? ratio : domain.energy->min_volume_ratio(state.positions).ratio;
      own >= FoldBarrier::activation_ratio ? barrier->look_at_roomy(state.positions)
                                           : barrier->look_at(state.positions);
      report.elastic_energy += barrier->value(state.positions, {});
    }
  }
  say();
}

std::optional<LiveContact> LiveScene::Contents::contact() const {
  LiveContact sum;
  bool can_touch = false;
  const auto add_parts = [&](const std::vector<PartForce>& parts) {
    for (const PartForce& part : parts) {
      sum.smallest_gap = std::min(sum.smallest_gap, part.distance);
      ++sum.active_pairs;
    }
  };
  const auto add_surfaces = [&](const SurfaceContact& contact) {
    can_touch = true;
    add_parts(contact.part_forces(state.positions, conditions()));
  };
  const auto add_nodes = [&](const ColliderBarrier& collider) {
    can_touch = true;
    const CarriedPoints& points = collider.points().places;
    for (Index point = 0; point < points.num_points(); ++point) {
      const double gap = collider.distance(points.at(world.dimension, point, state.positions), conditions());
      if (!(gap < collider.activation_distance())) continue;
      sum.smallest_gap = std::min(sum.smallest_gap, gap);
      ++sum.active_pairs;
    }
    if (const BallFacets* facets = collider.facets(); facets != nullptr)
      add_parts(facets->part_forces(state.positions, collider.ball(conditions())));
  };
  if (world.contact) add_surfaces(*world.contact);
  for (const auto& collider : world.mesh_colliders) add_surfaces(*collider);
  for (const auto& collider : world.colliders) add_nodes(*collider);
  if (floor) add_nodes(*floor->barrier());
  if (ball) add_nodes(*ball->barrier());
  return can_touch ? std::optional(sum) : std::nullopt;
}

void LiveScene::Contents::say() {
  std::string& text = report.state;
  text.clear();
  report.warnings.clear();
  const std::string share = format_short(report.relative_residual) + " of the load";
  if (report.at_rest) {
    text = "at rest: equilibrium of this mesh, the force residual is " + share;
  } else if (is_seeking()) {
    text = "nearly at rest: converging to the equilibrium, the force residual is " + share;
  } else if (!report.converged) {
    text = "not converged: after " + std::to_string(report.newton_iterations) +
           (report.newton_iterations == 1 ? " Newton iteration" : " Newton iterations") +
           " the force residual is " + share + "; the next step continues from there";
  }
  if (report.inverted_cells > 0) {
    report.warnings.push_back(std::to_string(report.inverted_cells) +
                              (report.inverted_cells == 1 ? " cell is" : " cells are") + " inverted");
  }
  if (mending_factor() > 1) report.warnings.emplace_back("motion is damped, because elements were inverted");
  for (std::string& coarse : coarseness_texts(world, report.discretisation_errors))
    report.warnings.push_back(std::move(coarse));
  report.words = text;
  for (const std::string& warning : report.warnings)
    report.words += (report.words.empty() ? "" : "; ") + warning;
}

}  // namespace resilin
