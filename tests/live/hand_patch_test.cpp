#include "resilin/live/hand_patch.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "playground.hpp"
#include "small_scenes.hpp"

namespace resilin::testing {
namespace {

Index node_at(const World& world, const Vector3& place) {
  for (Index node = 0; node < world.num_nodes(); ++node)
    if ((node_position(world.dimension, node, world.rest_positions) - place).norm() < 1e-9) return node;
  ADD_FAILURE() << "no node there";
  return 0;
}

TEST(HandPatch, TakesTheNodesAroundTheTouchedPlaceByHowNearTheyAre) {
  const World world(standing_block(8));
  const Index touched = node_at(world, {0.2, 0, 0.5});
  const MaterialPoint patch = hand_patch(world, {{touched}, {1.0}});
  EXPECT_GT(patch.nodes.size(), 3u);
  EXPECT_NEAR(std::accumulate(patch.weights.begin(), patch.weights.end(), 0.0), 1, 1e-14);
  const auto place = [&](Index node) { return node_position(3, node, world.rest_positions); };
  for (std::size_t a = 0; a < patch.nodes.size(); ++a) {
    EXPECT_GT(patch.weights[a], 0);
    for (std::size_t b = 0; b < patch.nodes.size(); ++b)
      if ((place(patch.nodes[a]) - place(touched)).norm() + 1e-9 <
          (place(patch.nodes[b]) - place(touched)).norm()) {
        EXPECT_GT(patch.weights[a], patch.weights[b]);
      }
  }
  EXPECT_EQ(
      patch.nodes[static_cast<std::size_t>(std::ranges::max_element(patch.weights) - patch.weights.begin())],
      touched);
}

/// Two blocks of one body that touch nowhere, nearer than a hand reaches.
TEST(HandPatch, DoesNotReachOverAGap) {
  Description scene = standing_block(4);
  Mesh& mesh = scene.bodies[0].mesh;
  const Mesh other = mesh;
  const auto shift = static_cast<Index>(mesh.vertices.size());
  for (const Vector3& vertex : other.vertices) mesh.vertices.push_back(vertex + Vector3(0.401, 0, 0));
  for (const Index node : other.blocks[0].nodes) mesh.blocks[0].nodes.push_back(node + shift);
  mesh.groups.clear();
  const World world(scene);
  const MaterialPoint patch = hand_patch(world, {{node_at(world, {0.4, 0.2, 0.5})}, {1.0}});
  for (const Index node : patch.nodes) EXPECT_LT(node_position(3, node, world.rest_positions).x(), 0.4005);
}

/// As on a large triangle of a skin, whose corners are carried by nodes far away.
TEST(HandPatch, OfAPlaceBetweenFarNodesIsAroundTheNodeNearestToIt) {
  const World world(standing_block(8));
  const MaterialPoint between{{node_at(world, {0, 0, 0}), node_at(world, {0, 0, 1})}, {0.5, 0.5}};
  const MaterialPoint patch = hand_patch(world, between);
  EXPECT_LT(patch.nodes.size(), 100u);
  for (const Index node : patch.nodes)
    EXPECT_LT((node_position(3, node, world.rest_positions) - Vector3(0, 0, 0.5)).norm(), 0.15);
}

/// How far the touched node is drawn out beyond those beside it [m].
double thorn(LiveScene& scene, const MaterialPoint& held, Index touched, const std::vector<Index>& beside) {
  const auto moved = [&](Index node) -> Vector3 {
    return node_position(3, node, scene.state().positions) -
           node_position(3, node, scene.world().rest_positions);
  };
  scene.grab(held, held.position(3, scene.state().positions) - Vector3(0, 0.3, 0));
  for (int i = 0; i < 60; ++i) scene.step(unhurried);
  Vector3 mean = Vector3::Zero();
  for (const Index node : beside) mean += moved(node) / static_cast<double>(beside.size());
  return (moved(touched) - mean).norm();
}

TEST(HandPatch, DrawsNoThorn) {
  const Description scene = standing_block(8, 0);
  LiveScene by_node(scene), by_patch(scene);
  const World& world = by_node.world();
  const Index touched = node_at(world, {0.2, 0, 0.8125});
  std::vector<Index> beside;
  for (const auto& [dx, dz] : {std::pair(0.05, 0.0), {-0.05, 0.0}, {0.0, 0.0625}, {0.0, -0.0625}})
    beside.push_back(node_at(world, {0.2 + dx, 0, 0.8125 + dz}));
  const MaterialPoint node{{touched}, {1.0}};
  const double sharp = thorn(by_node, node, touched, beside);
  const double blunt = thorn(by_patch, hand_patch(world, node), touched, beside);
  EXPECT_LT(blunt, 0.6 * sharp) << sharp;
  EXPECT_GT(by_patch.hand_force().norm(), 0);
  by_patch.release();
  EXPECT_EQ(by_patch.hand_force().norm(), 0);
}

}  // namespace
}  // namespace resilin::testing
