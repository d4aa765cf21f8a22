#include "resilin/world/colliders.hpp"

#include <algorithm>

#include "resilin/contact/catalog.hpp"
#include "resilin/core/error.hpp"
#include "resilin/core/text.hpp"
#include "resilin/material/rest_tangents.hpp"
#include "resilin/mesh/topology.hpp"
#include "resilin/world/friction.hpp"
#include "resilin/world/mesh_collider.hpp"

namespace resilin {
namespace {

constexpr double stiffness_share = 0.1;    ///< kappa / E: notes on "Convergent IPC", the authors' toolkit
constexpr double activation_share = 5e-3;  ///< of the smallest body's extent
constexpr double thickness_share = 0.1;    ///< of the thinnest body's thickness

double youngs_modulus(const Body& body) {
  const LawInfo& law = require_law(body.law, body.name);
  std::vector<double> constants;
  for (const auto& [name, value] : body.constants) constants.push_back(value);
  double E = 0;
  for_each_rest_tangent(law, constants, [&E](std::size_t, const double* A) {
    E = Hooke{A[9 + 1], A[4]}.youngs_modulus();  // dP_01/dF_01, dP_00/dF_11
  });
  return E;
}

double barrier_stiffness(const Body& body, std::optional<double> asked) {
  return asked ? *asked : stiffness_share * youngs_modulus(body);
}

CellBlock surface_facets(const Body& body) {
  return boundary({.kind = body.cell_kind, .nodes = body.cells}).facets;
}

}  // namespace

double smallest_extent(const World& world) {
  double smallest = std::numeric_limits<double>::infinity();
  for (const Body& body : world.bodies)
    smallest = std::min(smallest, largest_extent(body, world.rest_positions, world.dimension));
  return smallest;
}

std::vector<ContactBody> contact_bodies(const World& world, std::optional<double> stiffness) {
  std::vector<ContactBody> bodies;
  for (const Body& body : world.bodies)
    bodies.push_back({surface_facets(body), barrier_stiffness(body, stiffness)});
  return bodies;
}

std::vector<std::uint8_t> held_nodes(const World& world) {
  const int dim = world.dimension;
  const std::vector<std::int32_t> support_of = supports_of_unknowns(dim, world.num_nodes(), world.supports);
  std::vector<std::uint8_t> is_held;
  for (auto first = support_of.begin(); first != support_of.end(); first += dim)
    is_held.push_back(std::all_of(first, first + dim, [](std::int32_t support) { return support >= 0; }));
  return is_held;
}

std::vector<ContactNode> contact_nodes(const World& world, std::optional<double> stiffness) {
  const int dim = world.dimension;
  const std::vector<std::uint8_t> is_held = held_nodes(world);
  std::vector<ContactNode> all;
  for (const Body& body : world.bodies) {
    const double kappa = barrier_stiffness(body, stiffness);
    for (const ContactNode& node : contact_nodes(dim, surface_facets(body), world.rest_positions, kappa))
      if (is_held[static_cast<std::size_t>(node.node)] == 0) all.push_back(node);
  }
  return all;
}

double thinnest_extent(const World& world, const Body& body) {
  double least = std::numeric_limits<double>::infinity();
  for (int k = 0; k < world.dimension; ++k)
    least = std::min(least, reach_along(k, body, world.rest_positions, world.dimension).length());
  return least;
}

double default_activation_distance(const World& world) {
  double distance = activation_share * smallest_extent(world);
  for (const Body& body : world.bodies)
    distance = std::min(distance, thickness_share * thinnest_extent(world, body));
  return distance;
}

ColliderMotion motion_of(const ColliderDescription& description, double end_time) {
  ColliderMotion motion{.velocity = description.velocity,
                        .until = description.until.value_or(std::numeric_limits<double>::infinity()),
                        .displacement = description.displacement,
                        .time_function = description.time_function,
                        .turn = description.rotate};
  if (motion.time_function.is_constant())
    motion.time_function.form = TimeFunction::Ramp{.from = 0, .until = end_time};
  const ShapeKind* kind = find_shape_kind(description.kind);
  motion.turns_in_place = motion.turn && kind != nullptr && kind->is_round_about != nullptr &&
                          kind->is_round_about(description.shape, *motion.turn);
  return motion;
}

void add_collider(const ColliderDescription& description, World& world) {
  const ShapeKind* kind = find_shape_kind(description.kind);
  if (kind == nullptr) {
    std::vector<std::string> names;
    for (const ShapeKind& each : shape_kinds()) names.emplace_back(each.name);
    throw InputError(description.place + ".kind", "one of " + join(names), '"' + description.kind + '"');
  }
  if (world.dimension == 2 && !kind->is_flat_too) {
    throw InputError(description.place + ".kind", "a kind that there is in 2D", '"' + description.kind + '"',
                     "take a sphere, a box or a capsule");
  }
  if (world.modes) {
    throw InputError(description.place, "no [[collider]] where free vibrations are sought", "one",
                     "what only touches does not vibrate along: hold it with [[fix]] instead");
  }
  check_friction(description.friction, description.place + ".friction", world);
  const double activation_distance =
      description.activation_distance.value_or(default_activation_distance(world));
  if (kind->make_mesh != nullptr) {
    world.mesh_colliders.push_back(make_mesh_collider(description, *kind, activation_distance, world));
    world.terms.push_back(world.mesh_colliders.back());
    return;
  }
  world.colliders.push_back(
      std::make_shared<ColliderBarrier>(description.name, world.dimension, kind->make(description.shape),
                                        contact_nodes(world, description.stiffness), activation_distance,
                                        motion_of(description, world.end_time), description.friction));
  world.terms.push_back(world.colliders.back());
  check_is_outside(*world.colliders.back(), world, world.start_positions, {}, description.place);
}

void check_is_outside(const ColliderBarrier& collider, const World& world, const VectorX& positions,
                      const Conditions& conditions, const std::string& place) {
  const ColliderBarrier::Nearest nearest = collider.nearest(positions, conditions);
  if (nearest.distance > 0) return;
  const Body& body = world.body_of(nearest.node);
  const double gap = 0.5 * collider.activation_distance();
  throw InputError(
      place, "bodies that start outside, with a gap",
      "vertex " + std::to_string(nearest.node - body.first_node) + " of \"" + body.name + "\" at " +
          world.place_text(world.place_of(nearest.node, positions)) + ", " +
          (nearest.distance == 0 ? "on its surface" : format_short(-nearest.distance) + " m inside"),
      "move the body (translate) or the collider by " + format_short(gap - nearest.distance) + " m or more");
}

}  // namespace resilin
