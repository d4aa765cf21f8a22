// Why a search ended without an equilibrium, in words.

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "resilin/core/dense.hpp"
#include "resilin/core/text.hpp"
#include "resilin/material/law.hpp"
#include "resilin/simulation/stage_solver.hpp"
#include "resilin/simulation/step.hpp"

namespace resilin {
namespace {

constexpr double all_but_flat = 0.05;  ///< a volume ratio of which every body is told
/// A volume ratio that cells with one pressure hardly have as a whole.
constexpr double lost_at_a_point = 0.5;
constexpr double far_stretched = 2;  ///< a stretch beyond which the volume says little

/// "cell 12 at (0.1, 0.2, 0)": the middle of its rest shape.
std::string cell_text(const World& world, const Body& body, Index cell) {
  const auto count = static_cast<std::size_t>(num_nodes(body.cell_kind));
  const std::span<const Index> nodes =
      std::span(body.cells).subspan(static_cast<std::size_t>(cell) * count, count);
  Vector3 middle = Vector3::Zero();
  for (const Index node : nodes) middle += world.place_of(node, world.rest_positions);
  return "cell " + std::to_string(cell) + " at " + world.place_text(middle / static_cast<double>(count));
}

struct Stretched {
  double stretch = 0;  ///< the largest principal one; nan where one is not a number
  Index cell = -1;
};

Stretched most_stretched(const Body& body, const VectorX& positions) {
  const std::vector<Matrix<3>> gradients = body.domains.deformation_gradients(positions);
  Stretched most;
  for (std::size_t i = 0; i < gradients.size(); ++i) {
    const Matrix<3>& F = gradients[i];
    const auto cell = static_cast<Index>(i) / body.domains.num_points();
    if (!F.allFinite()) return {std::numeric_limits<double>::quiet_NaN(), cell};
    if (F.norm() <= most.stretch) continue;  // no stretch is larger
    const double stretch = std::sqrt(dense::symmetric_eigenpairs3(F.transpose() * F).values[2]);
    if (stretch > most.stretch) most = {stretch, cell};
  }
  return most;
}

/// A point of a cell with one pressure may lose the volume that the whole cell keeps.
std::string mixed_text(const Body& body, double ratio) {
  if (!body.element.starts_with("P2P0") || !(ratio < lost_at_a_point)) return {};
  return " (P2P0 keeps the volume of whole cells, not of their points: take element = \"P2\", or \"Q1P0\" on "
         "quadrilaterals or hexahedra)";
}

/// Where the material of a body suffers most.
std::string strain_text(const World& world, const Body& body, const VectorX& positions) {
  const auto [ratio, flat_cell] = body.domains.min_volume_ratio(positions);
  std::string text = "; its smallest volume ratio is " + format_short(ratio) + ", in " +
                     cell_text(world, body, flat_cell) + mixed_text(body, ratio);
  const Stretched most = most_stretched(body, positions);
  if (!(most.stretch <= far_stretched))
    text +=
        "; it is stretched " + format_short(most.stretch) + " times in " + cell_text(world, body, most.cell);
  return text + describe_limit(body);
}

}  // namespace

std::string describe_limit(const Body& body) {
  std::string text;
  std::vector<std::string> told;
  for (const Domain& domain : body.domains) {
    if (domain.is_rigid) continue;
    const std::string end(domain.law_info().end_of_domain);
    if (end.empty() || std::ranges::find(told, domain.law) != told.end()) continue;
    told.push_back(domain.law);
    text += "; " + domain.law + " ends where " + end + ": reduce the load, or change the constants";
  }
  return text;
}

std::string describe_unsettled_friction(const StageReport& stage) {
  return "friction did not converge in " + std::to_string(stage.friction_rounds) + " iterations (imbalance " +
         format_short(100 * stage.friction_mismatch) +
         " % of the forces): use shorter steps or more contact.friction_iterations";
}

namespace {

/// "; the force residual is 3 N (0.1 of the load)", with numbers alone.
std::string residual_text(const NewtonReport& report) {
  if (!std::isfinite(report.residual)) return "; the force residual is no finite number";
  const std::string text = "; the force residual is " + format_short(report.residual) + " N";
  const double share = report.relative_residual();
  return std::isfinite(share) ? text + " (" + format_short(share) + " of the load)" : text;
}

/// With parts of the scene on several processes: the place of the largest residual, told by the one that has
/// it.
std::string place_of_worst(const World& world, const NewtonReport& report) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  const ProcessGroup& share = world.share;
  const double rank = share.exchange().rank();
  const double teller = share.smallest(report.worst_unknown >= 0 ? rank : infinity);
  if (!(teller < infinity)) return {};
  std::string text;
  if (teller == rank) {
    const Index node = report.worst_unknown / world.dimension;
    text = residual_text(report) + ", largest in \"" + world.body_of(node).name + "\" at " +
           world.place_text(node, world.rest_positions);
  }
  return share.exchange().tell(static_cast<int>(teller), text);
}

}  // namespace

std::string describe_failure(const World& world, const NewtonReport& report, const VectorX& positions) {
  std::string text = report.reason;
  if (!world.share.is_whole()) return text + place_of_worst(world, report);
  const Body* worst = nullptr;
  if (report.worst_unknown >= 0) {
    const Index node = report.worst_unknown / world.dimension;
    worst = &world.body_of(node);
    text += residual_text(report) + ", largest at vertex " + std::to_string(node - worst->first_node) +
            " of \"" + worst->name + "\" at " + world.place_text(node, world.rest_positions) +
            strain_text(world, *worst, positions);
  }
  for (const Body& body : world.bodies) {
    if (&body == worst) continue;
    const auto [ratio, cell] = body.domains.min_volume_ratio(positions);
    if (ratio > all_but_flat) continue;
    text += "; " + cell_text(world, body, cell) + " of \"" + body.name + "\" has volume ratio " +
            format_short(ratio);
  }
  return text;
}

}  // namespace resilin
