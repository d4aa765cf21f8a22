#include "resilin/world/colliders.hpp"

#include <algorithm>

#include "resilin/contact/catalog.hpp"
#include "resilin/core/error.hpp"
#include "resilin/core/text.hpp"
#include "resilin/material/rest_tangents.hpp"
#include "resilin/mesh/topology.hpp"

namespace resilin {
namespace {

constexpr double stiffness_share = 0.1;  ///< kappa / E: notes on "Convergent IPC", the authors' toolkit
constexpr double activation_share = 5e-3;

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

}  // namespace

double barrier_stiffness(const Body& body, std::optional<double> asked) {
  return asked ? *asked : stiffness_share * youngs_modulus(body);
}

std::vector<ContactNode> contact_nodes(const World& world, std::optional<double> stiffness) {
  const int dim = world.dimension;
  const std::vector<std::int32_t> support_of = supports_of_unknowns(dim, world.num_nodes(), world.supports);
  std::vector<ContactNode> all;
  for (const Body& body : world.bodies) {
    const CellBlock facets = boundary({.kind = body.cell_kind, .nodes = body.cells}).facets;
    const double kappa = barrier_stiffness(body, stiffness);
    for (const ContactNode& node : contact_nodes(dim, facets, world.rest_positions, kappa)) {
      bool is_free = false;
      for (int k = 0; k < dim; ++k) is_free |= support_of[static_cast<std::size_t>(node.node * dim + k)] < 0;
      if (is_free) all.push_back(node);
    }
  }
  return all;
}

double default_activation_distance(const World& world) {
  double smallest = std::numeric_limits<double>::infinity();
  for (const Body& body : world.bodies)
    smallest = std::min(smallest, largest_extent(body, world.rest_positions, world.dimension));
  return activation_share * smallest;
}

std::shared_ptr<const ColliderBarrier> make_collider(const ColliderDescription& description,
                                                     const World& world) {
  const ShapeKind* kind = find_shape_kind(description.kind);
  if (kind == nullptr) {
    std::vector<std::string> names;
    for (const ShapeKind& each : shape_kinds()) names.emplace_back(each.name);
    throw InputError(description.place + ".kind", "one of " + join(names), '"' + description.kind + '"');
  }
  if (world.modes) {
    throw InputError(description.place, "no [[collider]] where free vibrations are sought", "one",
                     "what only touches does not vibrate along: hold it with [[fix]] instead");
  }
  const double activation_distance =
      description.activation_distance.value_or(default_activation_distance(world));
  auto collider = std::make_shared<ColliderBarrier>(
      description.name, world.dimension, kind->make(description.shape),
      contact_nodes(world, description.stiffness), activation_distance,
      ColliderMotion{.velocity = description.velocity,
                     .until = description.until.value_or(std::numeric_limits<double>::infinity())});
  check_is_outside(*collider, world, world.start_positions, {}, description.place);
  return collider;
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
