#include "resilin/world/shown_colliders.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <span>

namespace resilin {
namespace {

constexpr double reach_of_endless = 1;  ///< in diagonals of the box around all bodies

struct RestBox {
  Vector3 low, high;
};

RestBox rest_box(const World& world) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  RestBox box{Vector3::Constant(infinity), Vector3::Constant(-infinity)};
  for (Index node = 0; node < world.num_nodes(); ++node) {
    const Vector3 X = node_position(world.dimension, node, world.rest_positions);
    box.low = box.low.cwiseMin(X);
    box.high = box.high.cwiseMax(X);
  }
  return box;
}

/// The corners of a facet without those that it repeats.
std::vector<Index> different_corners(std::span<const Index> facet) {
  std::vector<Index> corners;
  for (const Index corner : facet)
    if (std::ranges::find(corners, corner) == corners.end()) corners.push_back(corner);
  return corners;
}

/// Number of a collider in the scene file, from 0.
double number_in_scene(const World& world, const std::string& name) {
  const std::vector<ColliderDescription>& all = world.made_from->colliders;
  return static_cast<double>(std::ranges::find(all, name, &ColliderDescription::name) - all.begin());
}

}  // namespace

std::vector<ShownCollider> shown_colliders(const World& world) {
  std::vector<ShownCollider> shown;
  const RestBox box = rest_box(world);
  for (const auto& collider : world.colliders) {
    const ColliderShape& shape = collider->shape();
    const RigidPlace place = collider->motion().place(0);
    ShownCollider& added = shown.emplace_back();
    added = {.name = std::string(collider->name()),
             .mesh = shape.facets(world.dimension, place.inverse(0.5 * (box.low + box.high)),
                                  reach_of_endless * (box.high - box.low).norm()),
             .motion = collider->motion(),
             .is_closed = !shape.is_flat(),
             .is_endless = shape.is_flat()};
  }
  for (const auto& collider : world.mesh_colliders) {
    const ContactObstacle& obstacle = collider->obstacle();
    shown.push_back({.name = std::string(collider->name()),
                     .mesh = obstacle.mesh,
                     .motion = obstacle.motion,
                     .is_closed = is_closed(obstacle.mesh, world.dimension)});
  }
  return shown;
}

bool any_collider_moves(const World& world) {
  const auto moves = [](const auto& motion) { return !motion.is_at_rest(); };
  return std::ranges::any_of(world.colliders, [&](const auto& each) { return moves(each->motion()); }) ||
         std::ranges::any_of(world.mesh_colliders,
                             [&](const auto& each) { return moves(each->obstacle().motion); });
}

ColliderFacets collider_facets(const World& world, const Conditions& c) {
  constexpr std::array kinds = {CellKind::point, CellKind::line, CellKind::triangle};
  ColliderFacets all;
  std::map<CellKind, std::vector<double>> numbers;
  const auto dim = static_cast<std::size_t>(world.dimension);
  for (const ShownCollider& collider : shown_colliders(world)) {
    const double number = number_in_scene(world, collider.name);
    const auto first = static_cast<Index>(all.mesh.vertices.size());
    const RigidPlace place = collider.place(c);
    for (const Vector3& X : collider.mesh.vertices) all.mesh.vertices.push_back(world.origin + place(X));
    const std::span<const Index> facets = collider.mesh.facets;
    for (std::size_t f = 0; f + dim <= facets.size(); f += dim) {
      const std::vector<Index> corners = different_corners(facets.subspan(f, dim));
      const CellKind kind = kinds[corners.size() - 1];
      for (const Index corner : corners) all.mesh.block(kind).nodes.push_back(first + corner);
      numbers[kind].push_back(number);
    }
  }
  for (const CellBlock& block : all.mesh.blocks)
    all.numbers.insert(all.numbers.end(), numbers[block.kind].begin(), numbers[block.kind].end());
  return all;
}

}  // namespace resilin
