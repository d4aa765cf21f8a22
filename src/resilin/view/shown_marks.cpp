#include "resilin/view/shown_marks.hpp"

#include <algorithm>
#include <cmath>

namespace resilin {
namespace {

constexpr std::size_t most_support_vertices = 400, most_load_vertices = 80;

ShownMark mark_at(ShownMark::Kind kind, std::string name, const std::vector<Index>& nodes, std::size_t most,
                  const ShownSurface& surface) {
  ShownMark made{.kind = kind, .name = std::move(name), .vertices = {}, .directions = {}};
  std::vector<Index> shown;
  for (const Index node : nodes)
    if (const std::optional<Index> vertex = surface.vertex_of(node)) shown.push_back(*vertex);
  made.vertices = thinned(shown, most);
  return made;
}

/// Nodal forces of a term at rest when it is strongest; a motion is looked at at some times.
VectorX strongest_forces(const World& world, const Energy& term) {
  constexpr int times = 16;
  VectorX strongest = VectorX::Zero(world.rest_positions.size());
  for (int k = 1; k <= (world.is_dynamic ? times : 1); ++k) {
    const Conditions conditions =
        world.is_dynamic ? Conditions{.time = world.end_time * k / times, .load = 1} : world.at_load(1);
    VectorX gradient = VectorX::Zero(world.rest_positions.size());
    term.add_gradient(world.rest_positions, conditions, gradient);
    if (gradient.allFinite() && gradient.norm() > strongest.norm()) strongest = -gradient;
  }
  return strongest;
}

/// Course of a load during a run, relative to its strongest forces.
ShownMark::Course course_of(const World& world, const Energy& term, const VectorX& strongest) {
  const double square = strongest.squaredNorm();
  if (!(square > 0)) return {};
  const auto factor = [&](double share) {
    const Conditions conditions =
        world.is_dynamic ? Conditions{.time = world.end_time * share, .load = 1} : world.at_load(share);
    VectorX gradient = VectorX::Zero(world.rest_positions.size());
    term.add_gradient(world.rest_positions, conditions, gradient);
    return -gradient.dot(strongest) / square;
  };
  ShownMark::Course course{.is_over_load = !world.is_dynamic, .at = {}, .factors = {}};
  const auto sample = [&](int count) {
    course.at.clear();
    course.factors.clear();
    for (int k = 0; k <= count; ++k) {
      const double share = static_cast<double>(k) / count;
      course.at.push_back(world.is_dynamic ? world.end_time * share : share);
      course.factors.push_back(factor(share));
    }
  };
  constexpr int few = 5, many = 120;
  constexpr double rounding = 1e-9;
  sample(few);
  const double first = course.factors.front(), last = course.factors.back();
  bool is_straight = true;
  for (int k = 0; k <= few; ++k)
    is_straight = is_straight && std::abs(course.factors[static_cast<std::size_t>(k)] -
                                          (first + (last - first) * k / few)) < rounding;
  if (!is_straight)
    sample(many);
  else if (std::abs(last - first) < rounding)
    return {};
  else
    course = {course.is_over_load, {course.at.front(), course.at.back()}, {first, last}};
  return course;
}

ShownMark mark_of_load(const World& world, const Energy& term, const ShownSurface& surface) {
  const VectorX forces = strongest_forces(world, term);
  std::vector<Index> nodes;
  double greatest = 0;
  for (Index node = 0; node < world.num_nodes(); ++node)
    greatest = std::max(greatest, node_position(world.dimension, node, forces).norm());
  for (Index node = 0; node < world.num_nodes(); ++node)
    if (node_position(world.dimension, node, forces).norm() > 1e-6 * greatest) nodes.push_back(node);
  // Only the part at the surface is seen of a load on the inside, too.
  std::vector<Index> outside;
  for (const Index node : nodes)
    if (const std::optional<Index> vertex = surface.vertex_of(node); vertex && surface.is_outside(*vertex))
      outside.push_back(node);
  if (!outside.empty()) nodes = outside;
  ShownMark made{
      .kind = ShownMark::Kind::load, .name = std::string(term.name()), .vertices = {}, .directions = {}};
  made.greatest = greatest;
  made.course = course_of(world, term, forces);
  for (const Index node : thinned(nodes, most_load_vertices)) {
    const std::optional<Index> vertex = surface.vertex_of(node);
    if (!vertex) continue;
    made.vertices.push_back(*vertex);
    made.directions.emplace_back(node_position(world.dimension, node, forces) / greatest);
  }
  return made;
}

/// Motors and cables are drawn by themselves: see shown_connectors.
bool is_of_connector(const TermOrigin& origin) {
  using enum TermOrigin::Kind;
  return origin.kind == joint || origin.kind == spring || origin.kind == cable;
}

}  // namespace

std::vector<Index> thinned(const std::vector<Index>& all, std::size_t most) {
  if (all.size() <= most) return all;
  std::vector<Index> some;
  for (std::size_t i = 0; i < most; ++i) some.push_back(all[i * all.size() / most]);
  return some;
}

std::vector<Index> shown_support(const std::vector<Index>& vertices) {
  return thinned(vertices, most_support_vertices);
}

std::vector<ShownMark> shown_marks(const World& world, const ShownSurface& surface) {
  std::vector<ShownMark> marks;
  const auto add = [&marks](ShownMark made) {
    if (!made.vertices.empty()) marks.push_back(std::move(made));
  };
  for (const Support& support : world.supports)
    add(mark_at(ShownMark::Kind::support, support.name, support.nodes, most_support_vertices, surface));
  for (std::size_t i = 0; i < world.terms.size(); ++i) {
    const Energy& term = *world.terms[i];
    const bool is_connector = i < world.origins.size() && is_of_connector(world.origins[i]);
    if (term.properties().category == EnergyCategory::external && term.name() != "gravity" && !is_connector)
      add(mark_of_load(world, term, surface));
  }
  for (const Probe& probe : world.probes)
    if (probe.carriers.empty()) add(mark_at(ShownMark::Kind::probe, probe.name, {probe.node}, 1, surface));
  return marks;
}

}  // namespace resilin
