#include "resilin/world/colliders.hpp"

#include <limits>

#include "resilin/contact/catalog.hpp"
#include "resilin/core/error.hpp"
#include "resilin/core/text.hpp"
#include "resilin/world/axisymmetry.hpp"
#include "resilin/world/friction.hpp"
#include "resilin/world/meeting_surface.hpp"
#include "resilin/world/mesh_collider.hpp"

namespace resilin {
namespace {

ContactPoints points_of(const ContactPart& part) {
  ContactPoints points;
  for (std::size_t i = 0; i < part.nodes.size(); ++i) points.add({part.nodes[i], part.stiffness[i]});
  return points;
}

/// Between its vertices a facet may reach into a ball.
void check_facets_are_outside(const ColliderBarrier& collider, const World& world, const std::string& place) {
  if (collider.facets() == nullptr) return;
  const BallFacets::Nearest nearest = collider.facets()->nearest(world.start_positions, collider.ball({}));
  if (nearest.distance > 0) return;
  const ContactSurface& surface = collider.facets()->surface();
  const auto body =
      static_cast<std::size_t>(surface.parts.bodies[static_cast<std::size_t>(nearest.vertices[0])]);
  throw InputError(
      place, "bodies that start outside, with a gap",
      "a facet of \"" + world.bodies[body].name + "\" " +
          (nearest.distance == 0 ? "on its surface" : format_short(-nearest.distance) + " m inside"),
      "move the body (translate) or the collider by " +
          format_short(0.5 * collider.activation_distance() - nearest.distance) + " m or more");
}

}  // namespace

std::shared_ptr<const BallFacets> ball_facets(const World& world, double least_radius,
                                              std::optional<double> stiffness, double activation_distance,
                                              const Vector3& center) {
  ContactSurface surface = make_contact_surface(
      world.dimension, contact_bodies(world, stiffness), world.contact_shape(),
      ContactObstacle{.mesh = {.vertices = {center},
                               .facets = std::vector<Index>(static_cast<std::size_t>(world.dimension), 0)},
                      .motion = {}},
      depth_of(world));
  leave_held_out(surface, held_nodes(world));
  auto facets = std::make_shared<const BallFacets>(std::move(surface), world.contact_shape(), least_radius,
                                                   activation_distance);
  return facets->empty() ? nullptr : facets;
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

void add_collider(const ColliderDescription& description, World& world, const ContactPart* part) {
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
    throw InputError(description.place, "no [[collider]] in a modal analysis", "one",
                     "contact takes no part in modal analysis: use [[fix]] instead");
  }
  check_friction(description.friction, description.place + ".friction", world);
  const double activation_distance =
      description.activation_distance.value_or(default_activation_distance(world));
  if (kind->make_mesh != nullptr) {
    world.mesh_colliders.push_back(make_mesh_collider(description, *kind, activation_distance, world));
    world.terms.push_back(world.mesh_colliders.back());
    return;
  }
  const auto barrier = std::make_shared<ColliderBarrier>(
      description.name, world.dimension, kind->make(description.shape),
      part != nullptr ? points_of(*part) : contact_points(world, description.stiffness), activation_distance,
      motion_of(description, world.end_time), description.friction);
  if (part == nullptr && barrier->shape().radius() > 0)
    barrier->meet_facets(ball_facets(world, barrier->shape().radius(), description.stiffness,
                                     activation_distance, barrier->shape().reference_point()));
  world.colliders.push_back(barrier);
  world.terms.push_back(world.colliders.back());
  if (part != nullptr) return;  // the whole has been checked
  const ColliderBarrier& collider = *world.colliders.back();
  check_is_outside(collider, world, world.start_positions, {}, description.place);
  const ColliderShape& shape = collider.shape();
  if (!shape.is_flat())
    check_is_beside(shape.facets(world.dimension, shape.reference_point(), 0), description,
                    activation_distance, world);
  check_facets_are_outside(collider, world, description.place);
}

void check_is_outside(const ColliderBarrier& collider, const World& world, const VectorX& positions,
                      const Conditions& conditions, const std::string& place) {
  const ColliderBarrier::Nearest nearest = collider.nearest(positions, conditions);
  if (nearest.distance > 0) return;
  const ContactPoints& points = collider.points();
  const Body& body = world.body_of(points.places.nodes_of(nearest.point)[0]);
  const double gap = 0.5 * collider.activation_distance();
  throw InputError(
      place, "bodies that start outside, with a gap",
      point_name(body, points.numbers[static_cast<std::size_t>(nearest.point)]) + " at " +
          world.place_text(world.origin + points.places.at(world.dimension, nearest.point, positions)) +
          ", " + (nearest.distance == 0 ? "on its surface" : format_short(-nearest.distance) + " m inside"),
      "move the body (translate) or the collider by " + format_short(gap - nearest.distance) + " m or more");
}

}  // namespace resilin
