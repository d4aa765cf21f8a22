#include "resilin/simulation/oddities.hpp"

#include <algorithm>
#include <limits>
#include <numeric>
#include <span>

#include "resilin/contact/crossing.hpp"
#include "resilin/core/text.hpp"
#include "resilin/element/axisymmetric.hpp"
#include "resilin/element/jacobian_bound.hpp"
#include "resilin/simulation/force_balance.hpp"
#include "resilin/world/body_overlap.hpp"
#include "resilin/world/linear_constraints.hpp"

namespace resilin {
namespace {

constexpr const char* kept_apart = "although contact is enabled: this is a bug of the program";

/// Number of cells of a body, also of its parts with other processes.
Index num_cells_of_all(const World& world, const Body& body) {
  return static_cast<Index>(world.share.sum(static_cast<double>(body.num_cells())));
}

std::string inversion_text(const World& world, const Body& body, const InvertedCells& inverted) {
  return world.place + ": " + std::to_string(inverted.count) + " of " +
         std::to_string(num_cells_of_all(world, body)) + " cells of \"" + body.name + "\" " +
         (inverted.count == 1 ? "is" : "are") + " inverted, cell " + std::to_string(inverted.worst) +
         " most, with volume ratio " + format_short(inverted.ratio) + ": this is unphysical, but " +
         (world.share.is_whole() ? body.domains.of_cell(inverted.worst).law : body.domains.laws()) +
         " permits it; use a law that needs J > 0, such as neo_hookean, or reduce the load";
}

std::string folding_text(const World& world, const Body& body, const InvertedCells& folded) {
  return world.place + ": " + std::to_string(folded.count) + " of " +
         std::to_string(num_cells_of_all(world, body)) + " cells of \"" + body.name + "\" " +
         (folded.count == 1 ? "is" : "are") + " inverted between quadrature points, cell " +
         std::to_string(folded.worst) + " with volume ratio " + format_short(folded.ratio) +
         (folded.count == 1 ? "" : " among them") +
         (world.newton.inversion_bound == InversionBound::everywhere
              ? ", although newton.inversion_bound = \"everywhere\" is set: use finer cells"
              : ": newton.inversion_bound = \"everywhere\" prevents this for laws that need J > 0; so do "
                "finer cells");
}

/// Below this share of the mean over its cell the volume at a point is lost.
constexpr double lost_at_a_point = 0.5;
constexpr double largest_volume_change = 0.1;  ///< where a cell keeps its volume

/// Cells of a mixed element that keep their volume as a whole and lose it at points.
InvertedCells cells_with_lost_points(const Body& body, const VectorX& x) {
  InvertedCells found;
  if (!body.domains.element().has_mean_volume) return found;
  const std::vector<double> ratios = body.domains.volume_ratios(x);
  const auto num_points = static_cast<std::size_t>(body.domains.num_points());
  for (std::size_t first = 0; first < ratios.size(); first += num_points) {
    const auto points = std::span(ratios).subspan(first, num_points);
    const double mean = std::accumulate(points.begin(), points.end(), 0.) / static_cast<double>(num_points);
    const double least = std::ranges::min(points);
    const bool keeps_volume = std::abs(mean - 1) < largest_volume_change;
    if (!(keeps_volume && least > 0 && least < lost_at_a_point * mean))
      continue;  // inverted ones are told apart
    ++found.count;
    if (found.worst >= 0 && least >= found.ratio) continue;
    found.ratio = least;
    found.worst = static_cast<Index>(first / num_points);
  }
  return found;
}

std::string lost_point_text(const World& world, const Body& body, const InvertedCells& lost) {
  const std::string element = plane_name(body.element);
  return world.place + ": " + std::to_string(lost.count) + " of " +
         std::to_string(num_cells_of_all(world, body)) + " cells of \"" + body.name +
         "\" keep their volume as a whole but lose more than half of it at a point, cell " +
         std::to_string(lost.worst) + " most, with volume ratio " + format_short(lost.ratio) + ": " +
         element + " permits this shape without a physical cause; compare with " +
         (element == "P2P0" ? "element = \"P2\", or \"Q1P0\" on quadrilaterals or hexahedra" : "finer cells");
}

/// Those of all processes, the worst by its number in the whole body.
InvertedCells of_all(const World& world, const Body& body, InvertedCells found) {
  if (world.share.is_whole()) return found;
  constexpr double infinity = std::numeric_limits<double>::infinity();
  const auto number = static_cast<std::size_t>(&body - world.bodies.data());
  const double ratio = world.share.smallest(found.worst >= 0 ? found.ratio : infinity);
  const bool is_here = found.worst >= 0 && found.ratio == ratio;
  const double worst = world.share.smallest(is_here ? world.cell_number(number, found.worst) : infinity);
  found.count = static_cast<Index>(world.share.sum(static_cast<double>(found.count)));
  found.worst = worst < infinity ? static_cast<Index>(worst) : -1;
  found.ratio = ratio;
  return found;
}

}  // namespace

InvertedCells inverted_cells(const Body& body, const VectorX& x) {
  const std::vector<double> ratios = body.domains.volume_ratios(x);
  const auto num_points = static_cast<std::size_t>(body.domains.num_points());
  InvertedCells found;
  for (std::size_t first = 0; first < ratios.size(); first += num_points) {
    bool is_inverted = false;
    for (const double ratio : std::span(ratios).subspan(first, num_points)) {
      if (ratio > 0) continue;
      is_inverted = true;
      if (ratio >= found.ratio) continue;
      found.ratio = ratio;
      found.worst = static_cast<Index>(first / num_points);
    }
    if (is_inverted) ++found.count;
  }
  return found;
}

Index num_inverted_cells(const World& world, const State& state) {
  Index count = 0;
  if (world.modes) return count;
  for (const Body& body : world.bodies) count += inverted_cells(body, state.positions).count;
  return static_cast<Index>(world.share.sum(static_cast<double>(count)));
}

InvertedCells folded_cells(const Body& body, const World& world, const VectorX& x) {
  InvertedCells found;
  const ElementInfo& element = body.domains.element();
  const int dim = world.dimension, num_nodes = resilin::num_nodes(body.cell_kind);
  if (num_nodes == dim + 1) return found;  // J is the same everywhere
  const std::vector<double> ratios = body.domains.volume_ratios(x);
  const auto num_points = static_cast<std::size_t>(body.domains.num_points());
  const auto places = [&](Index cell, const VectorX& all) {
    std::vector<double> of_cell;
    for (int a = 0; a < num_nodes; ++a) {
      const Index node = body.cells[static_cast<std::size_t>(cell * num_nodes + a)];
      for (int k = 0; k < dim; ++k) of_cell.push_back(all[Eigen::Index{node} * dim + k]);
    }
    return of_cell;
  };
  for (Index cell = 0; cell < body.num_cells(); ++cell) {
    const auto points = std::span(ratios).subspan(static_cast<std::size_t>(cell) * num_points, num_points);
    if (!std::ranges::all_of(points, [](double ratio) { return ratio > 0; })) continue;
    const JacobianSign sign = jacobian_sign(element, places(cell, x));
    if (sign.kind != JacobianSign::Kind::not_positive) continue;
    const double ratio = sign.value / jacobian(element, sign.xi, places(cell, world.rest_positions));
    ++found.count;
    if (found.worst >= 0 && ratio >= found.ratio) continue;
    found.ratio = ratio;
    found.worst = cell;
  }
  return found;
}

std::vector<std::string> oddities(const World& world, const State& state) {
  std::vector<std::string> found;
  if (world.modes) return found;  // drawn, not reached
  for (const Body& body : world.bodies)
    if (const InvertedCells inverted = of_all(world, body, inverted_cells(body, state.positions));
        inverted.count > 0)
      found.push_back(inversion_text(world, body, inverted));
  for (const Body& body : world.bodies)
    if (const InvertedCells folded = of_all(world, body, folded_cells(body, world, state.positions));
        folded.count > 0)
      found.push_back(folding_text(world, body, folded));
  for (const Body& body : world.bodies)
    if (const InvertedCells lost = of_all(world, body, cells_with_lost_points(body, state.positions));
        lost.count > 0)
      found.push_back(lost_point_text(world, body, lost));
  if (!world.is_dynamic)
    for (const std::string& text : describe_lost_digits(world, state))
      found.push_back(world.place + ": " + text);
  if (!world.share.is_whole()) return found;  // bodies that meet are none that several processes share
  std::vector<std::shared_ptr<const SurfaceContact>> contacts(world.mesh_colliders.begin(),
                                                              world.mesh_colliders.end());
  if (world.contact) contacts.push_back(world.contact);
  for (const auto& contact : contacts) {
    const CollisionSurface& parts = contact->surface().parts;
    const VectorX places = contact->surface().places(state.positions, conditions_of(state));
    if (const auto crossing = first_crossing(parts, contact->meetings(), places))
      found.push_back(world.place + ": surfaces penetrate each other near " +
                      world.place_text(vertices_of(*crossing, parts)[0], places) + ", " + kept_apart);
  }
  const std::vector<BodyOverlap> now = overlapping_bodies(world, state.positions, world.contact.get());
  if (now.empty()) return found;
  const std::vector<BodyOverlap> before =
      overlapping_bodies(world, world.start_positions, world.contact.get());
  for (const BodyOverlap& overlap : now) {
    // Tied surfaces meet in the mean alone.
    if (world.constraints && world.constraints->ties(overlap.body, overlap.other)) continue;
    const bool is_old = std::ranges::any_of(before, [&](const BodyOverlap& other) {
      return other.body == overlap.body && other.other == overlap.other;
    });
    if (!is_old)
      found.push_back(world.place + ": " + describe(world, overlap) + ": they penetrate each other, " +
                      (world.meet(overlap.body, overlap.other)
                           ? kept_apart
                           : "because contact between them is disabled ([contact])"));
  }
  return found;
}

}  // namespace resilin
