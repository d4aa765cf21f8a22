#include "resilin/live/held_face.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "playground.hpp"
#include "resilin/core/error.hpp"

namespace resilin::testing {
namespace {

/// Vertices of the first body at this height.
std::vector<Index> vertices_at(const LiveScene& scene, double z) {
  std::vector<Index> vertices;
  for (Index v = 0; v < scene.world().num_nodes(); ++v)
    if (std::abs(node_position(3, v, scene.world().rest_positions).z() - z) < 1e-9) vertices.push_back(v);
  return vertices;
}

Vector3 place_of(const LiveScene& scene, Index node) {
  return node_position(3, node, scene.state().positions);
}

void run(LiveScene& scene, int num_steps) {
  for (int i = 0; i < num_steps; ++i) scene.step(unhurried);
}

TEST(HeldFace, StaysWhereItIsUntilItIsLetGo) {
  LiveScene scene(standing_block(2));
  const std::vector<Index> top = vertices_at(scene, 1);
  run(scene, 5);  // it sags
  const Vector3 before = place_of(scene, top[0]);
  EXPECT_LT(before.z(), 1 - 1e-4);
  const int number = scene.hold(0, top);
  ASSERT_EQ(scene.held_faces().size(), 1u);
  EXPECT_EQ(scene.held_faces()[0].vertices, top);
  run(scene, 20);
  EXPECT_EQ(place_of(scene, top[0]), before);
  scene.reset();
  run(scene, 20);
  EXPECT_EQ(scene.held_faces().size(), 1u);
  EXPECT_EQ(place_of(scene, top[0]), node_position(3, top[0], scene.world().rest_positions))
      << "after a reset";
  scene.let_go(number);
  EXPECT_TRUE(scene.held_faces().empty());
  run(scene, 20);
  EXPECT_LT(place_of(scene, top[0]).z(), 1 - 1e-4);
}

TEST(HeldFace, OfTwoThatOverlapEachHoldsAlone) {
  LiveScene scene(standing_block(2));
  const std::vector<Index> top = vertices_at(scene, 1);
  const int first = scene.hold(0, top), second = scene.hold(0, top);
  EXPECT_NE(first, second);
  scene.let_go(first);
  run(scene, 10);
  EXPECT_EQ(place_of(scene, top[0]), node_position(3, top[0], scene.world().rest_positions));
}

/// Nothing is left to solve for.
TEST(HeldFace, MayHoldEveryNode) {
  LiveScene scene(standing_block(1));
  std::vector<Index> all;
  for (Index v = 0; v < scene.world().num_nodes(); ++v) all.push_back(v);
  scene.hold(0, all);
  run(scene, 10);
  EXPECT_EQ(scene.state().positions, scene.world().rest_positions);
  EXPECT_TRUE(scene.report().converged);
}

TEST(HeldFace, RefusesWhatASupportMovesAndWhatIsNotThere) {
  Description moving = standing_block(2);
  moving.fixes[0].displacement = {0, 0, 0.1};
  LiveScene scene(moving);
  EXPECT_THROW(scene.hold(0, vertices_at(scene, 0)), InputError);
  EXPECT_THROW(scene.hold(1, {0}), InputError);
  EXPECT_THROW(scene.hold(0, {-1}), InputError);
  EXPECT_THROW(scene.hold(0, {scene.world().num_nodes()}), InputError);
  EXPECT_THROW(scene.hold(0, {}), InputError);
  EXPECT_TRUE(scene.held_faces().empty());
  scene.let_go(7);
  run(scene, 2);
}

}  // namespace
}  // namespace resilin::testing
