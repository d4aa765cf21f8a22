// Free rigid-body motions of a static body, and the words for them.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/QR>
#include <random>

#include "small_scenes.hpp"

namespace resilin::testing {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

/// A bar without supports and loads: [0, 1] x [0, 0.25]^2, in 2D [0, 1] x [0, 0.25].
Description loose_bar(int dimension) {
  Description scene = small_bar(dimension, false);
  scene.gravity.setZero();
  scene.fixes.clear();
  return scene;
}

/// Holds the vertex nearest to this place, in these components.
void hold(Description& scene, const Vector3& at, const std::string& components = "xyz") {
  const std::vector<Vector3>& vertices = scene.bodies[0].mesh.vertices;
  const auto nearest =
      std::ranges::min_element(vertices, {}, [&](const Vector3& X) { return (X - at).norm(); });
  FixDescription fix;
  fix.name = "fix " + std::to_string(scene.fixes.size());
  fix.where.kind = Where::Kind::vertices;
  fix.where.vertices = {static_cast<Index>(nearest - vertices.begin())};
  for (std::size_t k = 0; k < 3; ++k) fix.components[k] = components.find("xyz"[k]) != components.npos;
  scene.fixes.push_back(fix);
}

TEST(AStaticBody, MayTurnAboutTheOneVertexThatIsHeld) {
  Description scene = loose_bar(3);
  hold(scene, {1, 0.25, 0});
  EXPECT_THAT(
      refusal_of(scene),
      AllOf(HasSubstr("3 of 6 rigid-body motions are free in a static analysis: rotation about x through "
                      "(1, 0.25, 0), rotation about y through (1, 0.25, 0), rotation about z "
                      "through (1, 0.25, 0); add a [[fix]] on a vertex away from the axis"),
            Not(HasSubstr("translation"))));
  scene = loose_bar(2);
  hold(scene, {1, 0.25, 0});
  EXPECT_THAT(refusal_of(scene),
              HasSubstr("1 of 3 rigid-body motions are free in a static analysis: rotation about "
                        "(1, 0.25); add a [[fix]] on a vertex away from this point"));
}

TEST(AStaticBody, MayTurnAboutTheLineThroughTwoVertices) {
  Description scene = loose_bar(3);
  hold(scene, {0, 0, 0.25});
  hold(scene, {1, 0, 0.25});
  EXPECT_THAT(refusal_of(scene),
              HasSubstr("1 of 6 rigid-body motions are free in a static analysis: rotation about x "
                        "through (0.5, 0, 0.25);"));
  // Turned by atan(4/3) about z: the line is named by its direction.
  scene.bodies[0].rotate =
      Rotation{.axis = Vector3::UnitZ(), .degrees = std::atan2(4, 3) * 180 / std::acos(-1)};
  EXPECT_THAT(refusal_of(scene), HasSubstr("rotation about (0.6, 0.8, 0) through (0.3, 0.4, 0.25);"));
}

TEST(AStaticBody, IsHeldByThreeVerticesThatAreNotInALine) {
  Description scene = loose_bar(3);
  hold(scene, {0, 0, 0});
  hold(scene, {0.5, 0, 0});
  hold(scene, {1, 0, 0});
  EXPECT_THAT(refusal_of(scene), HasSubstr("1 of 6"));
  hold(scene, {0, 0.25, 0});
  EXPECT_EQ(refusal_of(scene), "");
  scene = loose_bar(2);
  hold(scene, {0, 0, 0});
  hold(scene, {1, 0, 0}, "y");
  EXPECT_EQ(refusal_of(scene), "");
}

TEST(AStaticBody, MaySlideWhereAPlaneHoldsItsNormalAlone) {
  Description scene = loose_bar(3);
  FixDescription plane;
  plane.where.kind = Where::Kind::plane;
  plane.components = {true, false, false};
  scene.fixes = {plane};
  // With two translations a turn about x is one about any axis along it.
  EXPECT_THAT(refusal_of(scene),
              HasSubstr("3 of 6 rigid-body motions are free in a static analysis: translation along "
                        "y, translation along z, rotation about x; add a [[fix]] on a face"));
  hold(scene, {1, 0, 0}, "y");
  hold(scene, {1, 0, 0.25}, "y");
  EXPECT_THAT(refusal_of(scene),
              HasSubstr("1 of 6 rigid-body motions are free in a static analysis: translation along "
                        "z; add a [[fix]] of one vertex in these directions"));
  hold(scene, {1, 0.25, 0}, "z");
  EXPECT_EQ(refusal_of(scene), "");
}

TEST(AStaticBody, IsNamedByItsPartWhereItHasSeveral) {
  Description scene = loose_bar(3);
  Mesh& mesh = scene.bodies[0].mesh;
  const Mesh far = make_box({1, 1, 1}, {1, 1, 1}, {4, 4, 4});
  const auto first = static_cast<Index>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), far.vertices.begin(), far.vertices.end());
  for (const Index node : far.blocks[0].nodes) mesh.blocks[0].nodes.push_back(first + node);
  FixDescription wall;
  wall.where.kind = Where::Kind::plane;
  scene.fixes = {wall};
  EXPECT_THAT(
      refusal_of(scene),
      HasSubstr(
          "component 2 (8 vertices around (4.5, 4.5, 4.5)) is not constrained: 6 of 6 rigid-body motions"));
  for (const Vector3& corner : {Vector3(4, 4, 4), Vector3(5, 4, 4), Vector3(4, 5, 4)}) hold(scene, corner);
  EXPECT_EQ(refusal_of(scene), "");
}

TEST(AStaticBody, IsHeldBySpringsButNotByLoads) {
  for (const int dimension : {2, 3}) {
    Description scene = loose_bar(dimension);
    LoadDescription load;
    load.kind = "body_force";
    load.value = Vector3::UnitX();
    load.where.kind = Where::Kind::all;
    scene.loads = {load};
    EXPECT_THAT(refusal_of(scene), HasSubstr(dimension == 3 ? "6 of 6" : "3 of 3"));
    scene.loads[0].kind = "spring";
    scene.loads[0].stiffness = 1;
    EXPECT_EQ(refusal_of(scene), "");
  }
}

/// A floor carries what stands on it, and holds nothing sideways; from afar it holds nothing.
TEST(AStaticBody, StandsOnAColliderThatItTouches) {
  Description scene = loose_bar(3);
  ColliderDescription floor;
  floor.name = "floor";
  floor.shape.normal = Vector3::UnitZ();
  floor.shape.point = {0, 0, -1e-3};
  floor.activation_distance = 0.01;
  scene.colliders = {floor};
  EXPECT_THAT(
      refusal_of(scene),
      AllOf(HasSubstr(
                "3 of 6 rigid-body motions are free in a static analysis: translation along x, translation "
                "along y, rotation about z;"),
            HasSubstr("constrains a body only within the activation distance at the start")));
  scene.colliders[0].shape.point.z() = -1;
  EXPECT_THAT(refusal_of(scene), HasSubstr("6 of 6"));
}

/// A body carries another one that it touches, if it is held itself: two that only hold each other float.
TEST(AStaticBody, StandsOnABodyThatIsHeld) {
  Description scene = loose_bar(3);
  scene.bodies.push_back(scene.bodies[0]);
  scene.bodies[0].name = "lower";
  scene.bodies[1].name = "upper";
  scene.probes.clear();
  scene.bodies[1].translate = scene.bodies[0].translate + Vector3(0, 0, 0.25 + 1e-3);
  scene.contact.activation_distance = 0.01;
  EXPECT_THAT(refusal_of(scene), HasSubstr("body \"lower\" is not constrained: 6 of 6"));
  FixDescription foot;
  foot.name = "foot";
  foot.body = "lower";
  foot.where.kind = Where::Kind::plane;
  foot.where.axis = 2;
  scene.fixes.push_back(foot);
  EXPECT_THAT(
      refusal_of(scene),
      AllOf(HasSubstr("body \"upper\" is not constrained: 3 of 6 rigid-body motions are free in a static "
                      "analysis: translation "
                      "along x, translation along y, rotation about z"),
            HasSubstr("constrains a body only within the activation distance at the start")));
  scene.bodies[1].translate.z() += 0.1;
  EXPECT_THAT(refusal_of(scene), HasSubstr("body \"upper\" is not constrained: 6 of 6"));
}

TEST(ABodyInMotion, NeedsNoSupport) {
  Description scene = loose_bar(3);
  scene.is_dynamic = true;
  EXPECT_EQ(refusal_of(scene), "");
}

/// The motions that are free are those that move no held component: 6 less the rank of what these say.
TEST(AStaticBody, HasAsManyFreeMotionsAsItsSupportsLeave) {
  std::mt19937 random(4);
  int num_held = 0;
  for (int trial = 0; trial < 60; ++trial) {
    Description scene = loose_bar(3);
    std::vector<Vector3> vertices = scene.bodies[0].mesh.vertices;
    std::ranges::shuffle(vertices, random);
    const auto num_fixes = 1 + static_cast<std::size_t>(random() % 5);
    Eigen::MatrixXd held(0, 6);
    for (std::size_t i = 0; i < num_fixes; ++i) {
      std::string components;
      for (int k = 0; k < 3; ++k) {
        if (random() % 2 == 0) continue;
        components += "xyz"[k];
        held.conservativeResize(held.rows() + 1, 6);
        held.row(held.rows() - 1) << Vector3::Unit(k).transpose(),
            vertices[i].cross(Vector3::Unit(k)).transpose();
      }
      if (!components.empty()) hold(scene, vertices[i], components);
    }
    Eigen::Index rank = 0;
    if (held.rows() > 0) {
      Eigen::ColPivHouseholderQR<Eigen::MatrixXd> decomposition(held);
      decomposition.setThreshold(1e-9);
      rank = decomposition.rank();
    }
    const std::string message = refusal_of(scene);
    if (rank == 6) {
      ++num_held;
      EXPECT_EQ(message, "");
    } else {
      EXPECT_THAT(message,
                  HasSubstr(" is not constrained: " + std::to_string(6 - rank) + " of 6 rigid-body motions"));
    }
  }
  EXPECT_GT(num_held, 5);
  EXPECT_LT(num_held, 55);
}

/// Rigid rods of 1 m along x, each joined to the last one by this kind of joint, the first one to the ground.
Description chain_of_rods(int dimension, const std::vector<JointKind>& kinds) {
  Description scene = loose_bar(dimension);
  const BodyDescription rod = scene.bodies[0];
  scene.bodies.clear();
  scene.probes.clear();
  for (std::size_t i = 0; i < kinds.size(); ++i) {
    scene.bodies.push_back(rod);
    BodyDescription& body = scene.bodies.back();
    body.name = "rod " + std::to_string(i + 1);
    body.translate.x() = static_cast<double>(i);
    body.rigid = RigidDescription{.density = 1000};
    JointDescription joint;
    joint.kind = kinds[i];
    joint.bodies = {body.name};
    if (i > 0) joint.bodies.insert(joint.bodies.begin(), scene.bodies[i - 1].name);
    joint.at = {static_cast<double>(i), 0, 0};
    scene.joints.push_back(joint);
  }
  return scene;
}

TEST(AStaticChain, IsHeldThroughItsJoints) {
  using enum JointKind;
  for (const int dimension : {2, 3}) {
    EXPECT_EQ(refusal_of(chain_of_rods(dimension, {fixed})), "");
    EXPECT_EQ(refusal_of(chain_of_rods(dimension, {fixed, fixed, fixed})), "");
    // A hinge at the end takes from two rods what one cannot bear.
    Description arch = chain_of_rods(dimension, {hinge, hinge});
    arch.bodies[1].translate.y() = -0.2;  // not in a line
    JointDescription end = arch.joints[0];
    end.bodies = {"rod 2"};
    end.at = {2, -0.2, 0};
    arch.joints.push_back(end);
    EXPECT_EQ(refusal_of(arch), "");
    Description held_by_motors = chain_of_rods(dimension, {hinge, hinge, fixed});
    for (std::size_t i : {0, 1})
      held_by_motors.joints[i].motor = MotorDescription{
          .position = 0.1, .velocity = {}, .effort = {}, .stiffness = {}, .time_function = {}};
    EXPECT_EQ(refusal_of(held_by_motors), "");
  }
}

TEST(AStaticChain, OfWhichAPartCanMoveIsRefused) {
  using enum JointKind;
  EXPECT_THAT(
      refusal_of(chain_of_rods(2, {fixed, hinge, fixed})),
      AllOf(HasSubstr("body \"rod 2\" is not constrained: 1 of 3 rigid-body motions are free in a static "
                      "analysis: rotation about (1, 0); \"rod 3\" moves with it; add"),
            HasSubstr("joints, springs and motors hold bodies, too")));
  EXPECT_THAT(refusal_of(chain_of_rods(3, {hinge, hinge})),
              HasSubstr("body \"rod 1\" is not constrained: 1 of 6 rigid-body motions are free in a static "
                        "analysis: rotation about z through (0, 0, 0.125); \"rod 2\" moves with it"));
  EXPECT_THAT(refusal_of(chain_of_rods(3, {ball})), HasSubstr("3 of 6"));
  Description loose = chain_of_rods(3, {fixed, fixed});
  loose.joints.erase(loose.joints.begin());
  EXPECT_THAT(refusal_of(loose), HasSubstr("body \"rod 1\" is not constrained: 6 of 6"));
}

}  // namespace
}  // namespace resilin::testing
