#include "resilin/world/scene_origin.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <random>

#include "resilin/core/error.hpp"
#include "resilin/core/text.hpp"
#include "resilin/results/frame_file.hpp"
#include "resilin/simulation/simulation.hpp"
#include "small_scenes.hpp"

namespace resilin {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;

/// Everything that has a place, around the bar of `small_bar`.
Description scene_of_places(bool is_dynamic) {
  Description scene = testing::small_bar(3, is_dynamic);
  scene.end_time = 0.1;
  BodyDescription& bar = scene.bodies[0];
  bar.velocity = {0, 0.1, 0};
  bar.velocity_gradient << 0, 0.2, 0, -0.1, 0, 0.3, 0, 0, 0.1;
  FixDescription& wall = scene.fixes[0];
  wall.gradient << 0.01, 0, 0, 0, -0.02, 0, 0.01, 0, 0.03;
  ColliderDescription ball;
  ball.name = "ball";
  ball.kind = "sphere";
  ball.shape.center = {0.5, 0, -1.3};
  ball.shape.radius = 1;
  scene.colliders.push_back(ball);
  ColliderDescription floor;
  floor.name = "floor";
  floor.kind = "half_space";
  floor.shape.point = {0, 0, -0.5};
  floor.shape.normal = {0, 0, 1};
  scene.colliders.push_back(floor);
  SectionDescription middle;
  middle.name = "middle";
  middle.body = bar.name;
  middle.axis = 0;
  middle.at = 0.5;
  scene.sections.push_back(middle);
  return scene;
}

/// The same scene somewhere else, as a user would write it.
Description scene_at(Description scene, const Vector3& place) {
  BodyDescription& bar = scene.bodies[0];
  bar.translate += place;
  bar.velocity -= bar.velocity_gradient * place;
  FixDescription& wall = scene.fixes[0];
  wall.where.at += place[wall.where.axis];
  wall.where.tolerance = 0.001;
  wall.displacement -= wall.gradient * place;
  for (ColliderDescription& collider : scene.colliders) {
    collider.shape.center += place;
    collider.shape.point += place;
  }
  for (ProbeDescription& probe : scene.probes) probe.at += place;
  for (SectionDescription& section : scene.sections) section.at += place[section.axis];
  return scene;
}

struct ScenesFarAway : ::testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Places, ScenesFarAway, ::testing::Range(0, 12));

TEST_P(ScenesFarAway, MoveAsTheyDoAtTheOriginAndReportWhereTheyAre) {
  std::mt19937 generator(static_cast<unsigned>(GetParam()));
  std::uniform_real_distribution<double> component(-1, 1), digits(3, 6);
  const double far = std::pow(10, digits(generator));
  const Vector3 place = far * Vector3(component(generator), component(generator), component(generator));
  const Description here = scene_of_places(GetParam() % 2 == 1);
  const Simulation near = testing::run_all(here), moved = testing::run_all(scene_at(here, place));
  ASSERT_TRUE(near.is_finished() && moved.is_finished());
  EXPECT_EQ(near.world().origin, Vector3::Zero());
  EXPECT_NE(moved.world().origin, Vector3::Zero());
  const VectorX u = near.state().positions - near.world().rest_positions;
  const VectorX v = moved.state().positions - moved.world().rest_positions;
  // Numbers in the scene's own coordinates (a floor's height, v + G X) are rounded there.
  EXPECT_LT((u - v).cwiseAbs().maxCoeff(), 1e-13 * far);
  const VtuContent frame = frame_content(moved.world(), moved.state(), {});
  for (Index node = 0; node < moved.world().num_nodes(); ++node) {
    const Vector3 expected = place + node_position(3, node, near.state().positions);
    EXPECT_LT((frame.file.mesh.vertices[static_cast<std::size_t>(node)] - expected).norm(), 1e-12 * far);
  }
  // Moments are about the scene's origin, sections where they are cut.
  const Frame &by_us = near.frame(), &over_there = moved.frame();
  const Vector3 p = by_us.linear_momentum;
  EXPECT_LT((over_there.linear_momentum - p).norm(), 1e-9 * far);
  EXPECT_LT((over_there.angular_momentum - by_us.angular_momentum - place.cross(p)).norm(), 1e-9 * far * far);
  EXPECT_LT((over_there.sections[0].center - by_us.sections[0].center - place).norm(), 1e-12 * far);
  for (std::size_t i = 0; i < by_us.reactions.size(); ++i) {
    const Vector3 turned = by_us.reaction_torques[i] + place.cross(by_us.reactions[i].second);
    const double scale = by_us.reactions[0].second.norm() * far;
    EXPECT_LT((over_there.reaction_torques[i] - turned).norm(), 1e-6 * scale) << i;
  }
}

TEST(ScenesFarFromTheirOrigin, AreSpokenOfInTheirOwnCoordinates) {
  const Vector3 place(4e5, -2e5, 3e5);
  const auto far_bar = [&](bool is_dynamic) { return scene_at(testing::small_bar(3, is_dynamic), place); };
  Description inside = far_bar(true);
  ColliderDescription ball;
  ball.kind = "sphere";
  ball.shape.center = place + Vector3(1, 0.25, 0.25);
  ball.shape.radius = 0.02;
  inside.colliders = {ball};
  EXPECT_THAT(testing::refusal_of(inside), HasSubstr(" at (4e+05, -2e+05, 3e+05), 0.02 m inside"));
  Description loose = far_bar(false);
  for (const Index vertex : {0, 1}) {
    FixDescription hinge = loose.fixes[0];
    hinge.where.kind = Where::Kind::vertices;
    hinge.where.vertices = {vertex};
    (vertex == 0 ? loose.fixes[0] : loose.fixes.emplace_back()) = hinge;
  }
  EXPECT_THAT(testing::refusal_of(loose), HasSubstr(" through (4e+05, -2e+05, 3e+05)"));
  Description twice = far_bar(true);
  twice.bodies.push_back(twice.bodies[0]);
  twice.bodies[1].name = "other";
  twice.fixes[0].body = twice.probes[0].body = twice.bodies[0].name;
  EXPECT_THAT(testing::refusal_of(twice), HasSubstr("near (4e+05, -2e+05, 3e+05)"));
  twice.contact.is_enabled = false;
  EXPECT_THAT(all_warnings(World(twice)), Contains(HasSubstr("near (4e+05, -2e+05, 3e+05)")));
}

TEST(SceneOrigin, IsZeroForScenesNearTheirOwn) {
  for (const double distance : {0.0, 1.0, 50.0, -90.0}) {
    Description scene = testing::small_bar(3, false);
    scene.bodies[0].translate.y() = distance;
    EXPECT_EQ(find_scene_origin(scene), Vector3::Zero()) << distance;
  }
}

TEST(SceneOrigin, LeavesWhatIsWrongToTheChecksOfTheWorld) {
  for (const int wrong : {-1, 0, 1, 4, 1000}) {
    Description scene = scene_at(scene_of_places(false), {1e5, 0, 0});
    scene.fixes[0].where.axis = scene.sections[0].axis = wrong == 0 || wrong == 1 ? 3 : wrong;
    EXPECT_NE(find_scene_origin(scene), Vector3::Zero());
    EXPECT_THROW(World{scene}, InputError) << wrong;
    scene.dimension = wrong;
    EXPECT_EQ(find_scene_origin(scene), Vector3::Zero()) << wrong;
    EXPECT_THROW(World{scene}, InputError) << wrong;
  }
}

TEST(SceneOrigin, IsWhereTheFirstBodyWasTranslatedToOrTheMiddle) {
  Description scene = testing::small_bar(3, false);
  scene.bodies[0].translate = {1e6, -2e6, 0.3};
  EXPECT_EQ(find_scene_origin(scene), scene.bodies[0].translate);
  const Vector3 there = scene.bodies[0].translate;
  scene.bodies[0].translate.setZero();
  for (Vector3& X : scene.bodies[0].mesh.vertices) X += there;
  EXPECT_LT((find_scene_origin(scene) - there).norm(), 2);
}

}  // namespace
}  // namespace resilin
