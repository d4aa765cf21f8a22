#include "resilin/sensitivity/pressing_colliders.hpp"

#include "resilin/core/text.hpp"

namespace resilin {
namespace {

double weight_of(const World& world) {
  double mass = 0;
  for (const Body& body : world.bodies) mass += body.mass;
  return mass * world.gravity.head(world.dimension).norm();
}

}  // namespace

std::vector<PressingCollider> pressing_colliders(const World& world, const VectorX& positions) {
  const Conditions full = world.at_load(1);
  std::vector<PressingCollider> found;
  const auto add = [&](const Energy& collider, double gap, double activation_distance) {
    const std::optional<Reaction> reaction = collider.reaction(positions, full);
    if (reaction && reaction->force.norm() > 0)
      found.push_back({std::string(collider.name()), reaction->force.norm(), gap, activation_distance});
  };
  for (const auto& collider : world.colliders)
    add(*collider, collider->gap(positions, full), collider->activation_distance());
  for (const auto& collider : world.mesh_colliders)
    add(*collider, collider->smallest_gap(positions, full).distance, collider->activation_distance());
  return found;
}

std::string in_words(const PressingCollider& collider, const World& world) {
  const double weight = weight_of(world);
  return "the collider \"" + collider.name + "\" presses with " + format_short(collider.force) + " N" +
         (weight > 0 ? ", " + format_short(collider.force / weight) + " times the weight" : "") + ", from " +
         format_short(collider.gap) + " m away, with the activation distance " +
         format_short(collider.activation_distance) + " m on";
}

std::string collider_around(const World& world, const VectorX& positions) {
  for (const auto& collider : world.colliders) {
    const double distance = collider->gap(positions, {});
    if (distance <= 0)
      return format_short(-distance) + " m inside of the collider \"" + std::string(collider->name()) + '"';
  }
  return {};
}

}  // namespace resilin
