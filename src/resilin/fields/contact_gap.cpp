#include "resilin/fields/contact_gap.hpp"

#include <algorithm>

#include "resilin/mesh/facet.hpp"

namespace resilin {
namespace {

double largest_activation_distance(const World& world) {
  double largest = 0;
  if (world.contact) largest = world.contact->activation_distance();
  for (const auto& collider : world.colliders) largest = std::max(largest, collider->activation_distance());
  for (const auto& collider : world.mesh_colliders)
    largest = std::max(largest, collider->activation_distance());
  return largest;
}

void close_gaps(const SurfaceContact& contact, const State& state, VectorX& gaps) {
  for (const PartForce& part : contact.part_forces(state.positions, conditions_of(state)))
    for (std::size_t i = 0; i < static_cast<std::size_t>(num_vertices(part.kind)); ++i) {
      if (part.weights[i] == 0) continue;
      contact.surface().vertices.for_each_node(part.vertices[i], [&](Index node, double share) {
        if (share != 0) gaps[node] = std::min(gaps[node], part.distance);
      });
    }
}

}  // namespace

VectorX contact_gap(const World& world, const State& state) {
  VectorX gaps = VectorX::Constant(world.num_nodes(), largest_activation_distance(world));
  if (world.contact) close_gaps(*world.contact, state, gaps);
  for (const auto& collider : world.mesh_colliders) close_gaps(*collider, state, gaps);
  for (const auto& collider : world.colliders) {
    const CarriedPoints& points = collider->points().places;
    for (Index point = 0; point < points.num_points(); ++point) {
      const double distance =
          collider->distance(points.at(world.dimension, point, state.positions), conditions_of(state));
      if (!(distance < collider->activation_distance())) continue;
      points.for_each_node(point, [&](Index node, double) { gaps[node] = std::min(gaps[node], distance); });
    }
  }
  return gaps;
}

}  // namespace resilin
