#include "resilin/world/start_check.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <set>
#include <span>

#include "resilin/core/error.hpp"
#include "resilin/core/text.hpp"
#include "resilin/mesh/facet.hpp"
#include "resilin/world/axisymmetry.hpp"
#include "resilin/world/linear_constraints.hpp"
#include "resilin/world/meeting_surface.hpp"

namespace resilin {
namespace {

constexpr double flat_ratio = 1e-12;  ///< a volume ratio that rounding leaves of none

/// The least volume ratio at the points of a cell.
double least_volume_ratio(const ElasticEnergy& elastic, const std::vector<double>& ratios, Index cell) {
  const auto first = ratios.begin() + Eigen::Index{cell} * elastic.num_points();
  return *std::min_element(first, first + elastic.num_points());
}

[[noreturn]] void refuse_start(const BodyDescription& description, const Domain& domain, const VectorX& x) {
  const ElasticEnergy& elastic = *domain.energy;
  const std::string law(elastic.law().name), place = description.place + ".initial_positions";
  const std::vector<double> energies = elastic.energy_densities(x), ratios = elastic.volume_ratios(x);
  const auto bad = std::ranges::find_if(energies, [](double energy) { return !std::isfinite(energy); });
  const auto cell = static_cast<Index>((bad - energies.begin()) / elastic.num_points());
  if (bad == energies.end()) throw InputError(place, "a shape at which " + law + " has an energy", "none");
  const double ratio = least_volume_ratio(elastic, ratios, cell);
  const std::string where =
      "cell " + std::to_string(domain.number_of(cell)) + " with volume ratio " + format_short(ratio);
  if (!(ratio > 0) && elastic.law().needs_positive_J)
    throw InputError(
        place, "no inverted cell, since " + law + " needs J > 0", where,
        "start from a shape without one, or take a law that allows them, such as stable_neo_hookean");
  throw InputError(place, "an initial shape at which the energy of " + law + " is finite",
                   where + ", where it is not", "start nearer to the reference configuration");
}

/// Some times at which to look: where something begins or ends, between these, and in equal steps to the end.
std::vector<double> times_to_look_at(const World& world) {
  std::vector<double> times = {0, world.end_time};
  constexpr int equal_steps = 16;
  for (int i = 1; i < equal_steps; ++i) times.push_back(world.end_time * i / equal_steps);
  for (const double event : world.event_times)
    if (event > 0 && event < world.end_time) times.push_back(event);
  std::ranges::sort(times);
  const std::size_t count = times.size();
  for (std::size_t i = 1; i < count; ++i) times.push_back(0.5 * (times[i - 1] + times[i]));
  return times;
}

/// Conditions of the whole motion, or of a static run as far as it follows time; else those at the full load.
std::vector<Conditions> conditions_to_look_at(const World& world) {
  if (!world.is_dynamic && world.path_time == 0) return {{.load = 1}};
  std::vector<Conditions> all;
  for (const double time : times_to_look_at(world))
    all.push_back({.time = time, .load = world.is_dynamic ? 1 : time / world.path_time});
  return all;
}

bool acts(const World& world, const Conditions& conditions) {
  const VectorX& x = world.start_positions;
  VectorX placed = x;
  place_supports(world.dimension, world.supports, world.rest_positions, conditions, placed);
  if (placed != x) return true;
  if (world.constraints) {  // their constants may change
    set_constants(world, conditions, placed);
    world.constraints->dependents.place(VectorX(placed), placed);
    if ((placed - x).cwiseAbs().maxCoeff() > 1e-12 * x.cwiseAbs().maxCoeff()) return true;
  }
  VectorX gradient = VectorX::Zero(x.size()), magnitude = gradient;
  for (const auto& term : world.terms) {
    term->add_gradient(x, conditions, gradient);
    term->add_gradient_magnitude(x, conditions, magnitude);
  }
  constexpr double rounding = 1e-12;
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    const bool is_free = world.is_fixed[static_cast<std::size_t>(i)] == 0;
    if (is_free && !(std::abs(gradient[i]) <= rounding * magnitude[i])) return true;
  }
  return false;
}

/// Sum of a nodal vector over a body; in axisymmetric scenes along the axis, the rest of it is no motion.
Vector3 total(const World& world, const Body& body, const VectorX& nodal) {
  Vector3 sum = Vector3::Zero();
  for (Index node = body.first_node; node < body.first_node + body.num_nodes; ++node)
    sum += node_position(world.dimension, node, nodal);
  if (is_axisymmetric(world)) sum.x() = 0;
  return sum;
}

/// Whether no vertex of a body has a prescribed displacement along an axis.
bool is_free_along(const World& world, const Body& body, int axis) {
  for (Index node = body.first_node; node < body.first_node + body.num_nodes; ++node)
    if (world.is_fixed[static_cast<std::size_t>(Index{node} * world.dimension + axis)] != 0) return false;
  return true;
}

/// The largest total force of loads and gravity on each body, of all times looked at [N].
std::vector<double> largest_loads(const World& world) {
  std::vector<double> largest(world.bodies.size(), 0.0);
  for (const Conditions& conditions : conditions_to_look_at(world)) {
    VectorX gradient = VectorX::Zero(world.start_positions.size());
    for (std::size_t t = 0; t < world.origins.size(); ++t) {
      const TermOrigin::Kind kind = world.origins[t].kind;
      if (kind == TermOrigin::Kind::load || kind == TermOrigin::Kind::gravity)
        world.terms[t]->add_gradient(world.start_positions, conditions, gradient);
    }
    for (std::size_t b = 0; b < world.bodies.size(); ++b)
      largest[b] = std::max(largest[b], total(world, world.bodies[b], gradient).norm());
  }
  return largest;
}

/// How deep a held vertex gets into a collider.
struct Intrusion {
  double depth = 0;    ///< [m]
  std::string vertex;  ///< its name
  Conditions when;
};

/// Points of the surface that a body meets others with, or beneath it, where a support alone holds them.
ContactPoints points_held_by(const Support& support, const World& world) {
  ContactPoints points;
  if (support.nodes.empty()) return points;
  const Body& body = world.body_of(support.nodes[0]);
  if (!body.meets_with_skin()) {
    for (const Index node : support.nodes) points.add({node, 0});
    return points;
  }
  const std::set<Index> held(support.nodes.begin(), support.nodes.end());
  const CarriedPoints vertices = skin_vertices(body);
  for (Index vertex = 0; vertex < vertices.num_points(); ++vertex) {
    if (!std::ranges::all_of(vertices.nodes_of(vertex), [&](Index node) { return held.contains(node); }))
      continue;
    vertices.for_each_node(vertex, [&](Index node, double share) {
      points.places.nodes.push_back(node);
      points.places.shares.push_back(share);
    });
    points.places.end_row();
    points.numbers.push_back(vertex);
  }
  return points;
}

Intrusion deepest(const World& world, const Support& support, const ColliderBarrier& collider) {
  const ContactPoints points = points_held_by(support, world);
  Intrusion worst;
  for (const Conditions& conditions : conditions_to_look_at(world)) {
    for (Index point = 0; point < points.places.num_points(); ++point) {
      Vector3 x = Vector3::Zero();
      points.places.for_each_node(point, [&](Index node, double share) {
        x += share * support.target(node_position(world.dimension, node, world.rest_positions), conditions);
      });
      const double depth = -collider.distance(x, conditions);
      if (!(depth > worst.depth)) continue;
      const Index number = points.numbers[static_cast<std::size_t>(point)];
      worst = {
          .depth = depth, .vertex = point_name(world.body_of(support.nodes[0]), number), .when = conditions};
    }
  }
  return worst;
}

}  // namespace

std::vector<std::string> supports_in_colliders(const World& world) {
  const double touching = 1e-9 * world.largest_extent();
  std::vector<std::string> found;
  for (const auto& collider : world.colliders)
    for (const Support& support : world.supports) {
      const auto held = std::span(support.components).first(static_cast<std::size_t>(world.dimension));
      if (!std::ranges::all_of(held, std::identity())) continue;  // the other vertices feel the collider
      const Intrusion worst = deepest(world, support, *collider);
      if (!(worst.depth > touching)) continue;
      found.push_back(support.place + ": takes " + worst.vertex + " " + format_short(worst.depth) +
                      " m into the collider \"" + std::string(collider->name()) + "\"" +
                      (world.is_dynamic      ? " at t = " + format_short(worst.when.time) + " s"
                       : worst.when.load < 1 ? " at load factor " + format_short(worst.when.load)
                                             : "") +
                      ": fixed vertices have no contact with it");
    }
  return found;
}

void check_start(const Description& description, const World& world) {
  for (std::size_t b = 0; b < world.bodies.size(); ++b)
    for (const Domain& domain : world.bodies[b].domains)
      if (!std::isfinite(domain.energy->value(world.start_positions, {})))
        refuse_start(description.bodies[b], domain, world.start_positions);
}

std::vector<std::string> starts_without_volume(const World& world) {
  std::vector<std::string> found;
  for (const Body& body : world.bodies)
    for (const Domain& domain : body.domains) {
      if (domain.law_info().kind == LawKind::small_strain) continue;
      const std::vector<double> ratios = domain.energy->volume_ratios(world.start_positions);
      const auto flat = std::ranges::find_if(ratios, [](double J) { return std::abs(J) <= flat_ratio; });
      if (flat == ratios.end()) continue;
      const auto cell = static_cast<Index>((flat - ratios.begin()) / domain.energy->num_points());
      found.push_back("\"" + body.name + "\" starts with cells of no volume, cell " +
                      std::to_string(domain.number_of(cell)) +
                      " among them: forces and energies are finite, but the Cauchy stress, a force per area, "
                      "has no value there (inf or nan in the first frame)");
      break;
    }
  return found;
}

std::vector<PushedBody> pushed_bodies(const World& world, double times) {
  const std::size_t num_bodies = world.bodies.size();
  std::vector<Vector3> pushes(num_bodies, Vector3::Zero());  // sum of all contact on each body [N] ...
  std::vector<double> most(num_bodies, 0.0);                 // ... the most that one of them adds ...
  std::vector<PushedBody> found(num_bodies, PushedBody{});   // ... and which they are
  bool is_any_pushed = false;
  for (std::size_t t = 0; t < world.origins.size(); ++t) {
    const TermOrigin::Kind kind = world.origins[t].kind;
    if (kind != TermOrigin::Kind::collider && kind != TermOrigin::Kind::contact) continue;
    VectorX gradient = VectorX::Zero(world.start_positions.size());
    world.terms[t]->add_gradient(world.start_positions, {}, gradient);
    if (gradient.isZero(0)) continue;
    is_any_pushed = true;
    for (std::size_t b = 0; b < num_bodies; ++b) {
      const Vector3 push = -total(world, world.bodies[b], gradient);
      if (push.isZero(0)) continue;
      pushes[b] += push;
      found[b].terms.push_back(t);
      if (!(push.norm() > most[b])) continue;
      most[b] = push.norm();
      found[b].strongest = t;
    }
  }
  if (!is_any_pushed) return {};
  const std::vector<double> loads = largest_loads(world);
  for (std::size_t b = 0; b < num_bodies; ++b) {
    found[b].body = b;
    found[b].push = pushes[b].norm();
    found[b].load = loads[b];
  }
  std::erase_if(found, [&](const PushedBody& each) {
    int axis = 0;
    pushes[each.body].cwiseAbs().maxCoeff(&axis);
    constexpr double rounding = 1e-9;  // opposite pushes leave that much
    if (!(each.push > std::max(times * each.load, rounding * most[each.body]))) return true;
    if (!is_free_along(world, world.bodies[each.body], axis)) return true;
    return !world.is_dynamic && each.load == 0;  // a prescribed motion decides where it goes
  });
  return found;
}

std::vector<std::string> starts_pushed_off(const World& world) {
  constexpr double many_times = 10;  // a body at rest on others never feels that much
  std::vector<std::string> lines;
  for (const PushedBody& each : pushed_bodies(world, many_times)) {
    const bool by_collider = world.origins[each.strongest].kind == TermOrigin::Kind::collider;
    const std::string from =
        by_collider ? '"' + std::string(world.terms[each.strongest]->name()) + '"' : "another body";
    lines.push_back(world.place + ": \"" + world.bodies[each.body].name +
                    "\" starts inside the activation distance of " + from + ": contact pushes it away with " +
                    format_short(each.push) + " N" +
                    (each.load > 0 ? ", " + format_short(each.push / each.load) + " times its load" : "") +
                    "; start it farther away, or set activation_distance to " +
                    (world.is_dynamic ? "less than the gap" : "little more than the gap"));
  }
  return lines;
}

bool is_idle(const World& world) {
  for (std::size_t i = 0; world.is_dynamic && i < world.is_fixed.size(); ++i)
    if (world.is_fixed[i] == 0 && world.start_velocities[static_cast<Eigen::Index>(i)] != 0) return false;
  return std::ranges::none_of(conditions_to_look_at(world),
                              [&](const Conditions& conditions) { return acts(world, conditions); });
}

}  // namespace resilin
