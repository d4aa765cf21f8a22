// Derivatives of scenes with springs, cables, joints, rigid bodies, ties and constraints.

#include <gmock/gmock.h>

#include "derivative_checks.hpp"
#include "every_integrator.hpp"
#include "resilin/core/error.hpp"
#include "resilin/world/rigid_region.hpp"
#include "short_bar.hpp"

namespace resilin::testing {
namespace {

using ::testing::HasSubstr;

AnchorDescription on_bar(const Vector3& at) { return {.body = "body", .at = at}; }
AnchorDescription on_ground(const Vector3& at) { return {.body = "", .at = at}; }

/// The bar with a spring of each kind and two cables.
Description bar_on_springs(int dimension, bool is_dynamic) {
  Description scene = short_bar(dimension, is_dynamic);
  const double depth = dimension == 3 ? 0.25 : 0;
  CableDescription spring;
  spring.name = "support";
  spring.points = {on_bar({0.5, 0.25, depth}), on_ground({0.7, 0.6, depth})};
  spring.stiffness = 300;
  scene.springs.push_back(spring);
  spring.name = "strut";
  spring.points = {on_bar({0.3, 0, 0}), on_bar({0.5, 0.25, depth})};
  spring.rest_length = 0.35;
  spring.stiffness = 500;
  scene.springs.push_back(spring);
  spring.name = "stop";
  spring.points = {on_bar({0.5, 0.25, depth}), on_ground({0.7, 0.2, depth})};
  spring.rest_length.reset();
  spring.stiffness = 0;
  spring.elongations = {-0.1, 0.0031, 0.1};
  spring.forces = {-20, 0.62, 90};
  scene.springs.push_back(spring);
  CableDescription cable;
  cable.name = "tendon";
  cable.points = {on_ground({-0.2, 0.4, 0}), on_bar({0.2, 0.25, 0}), on_bar({0.5, 0.25, 0})};
  cable.stiffness = 400;
  cable.shortening = 0.05;
  cable.tension_only = true;
  scene.cables.push_back(cable);
  cable.name = "pull";
  cable.points = {on_bar({0.5, 0, depth}), on_ground({0.6, -0.5, 0})};
  cable.tension = 20;
  scene.cables.push_back(cable);
  return scene;
}

TEST(DerivativesOfSpringsAndCables, AreRightAtRest) {
  for (const int dimension : {2, 3}) expect_right_derivatives(bar_on_springs(dimension, false));
}

using CoupledDerivativesOfEveryIntegrator = WithEveryIntegrator;

TEST_P(CoupledDerivativesOfEveryIntegrator, AreRightForSpringsAndCables) {
  Description scene = bar_on_springs(2, true);
  scene.integrator = integrator;
  expect_right_derivatives(scene);
}

TEST(DerivativesOfSpringsAndCables, HaveNames) {
  EXPECT_THAT(parameter_names(World(bar_on_springs(2, false))),
              ::testing::IsSupersetOf({"spring.support.stiffness", "spring.support.rest_length",
                                       "spring.strut.rest_length", "cable.tendon.shortening",
                                       "cable.tendon.stiffness", "cable.pull.tension"}));
}

/// A bar whose far end carries a rigid plate, and the plate an arm on a sprung and driven hinge.
Description bar_with_arm(int dimension, bool is_dynamic) {
  Description scene = short_bar(dimension, is_dynamic);
  scene.bodies[0].mesh =
      dimension == 3 ? make_box({0.5, 0.25, 0.25}, {2, 1, 1}) : make_rectangle({0.5, 0.25}, {4, 2});
  scene.fixes[0].where.vertices.clear();
  for (std::size_t v = 0; v < scene.bodies[0].mesh.vertices.size(); ++v)
    if (scene.bodies[0].mesh.vertices[v][0] == 0)
      scene.fixes[0].where.vertices.push_back(static_cast<Index>(v));
  RegionDescription plate;
  plate.place = "plate";
  plate.name = "plate";
  plate.where.kind = Where::Kind::box;
  plate.where.min = {dimension == 3 ? 0.25 : 0.375, -1, -1};
  plate.where.max = {1, 1, 1};
  plate.rigid = RigidDescription{.density = 700, .stiffness = 1e7};
  scene.bodies[0].regions.push_back(plate);
  BodyDescription arm;
  arm.name = "arm";
  arm.mesh = dimension == 3 ? make_box({0.4, 0.05, 0.1}, {1, 1, 1}) : make_rectangle({0.4, 0.05}, {1, 1});
  arm.translate = {0.5, 0.1, dimension == 3 ? 0.1 : 0.0};
  arm.rigid = RigidDescription{.density = 300, .stiffness = 1e7};
  scene.bodies.push_back(arm);
  for (auto* list : {&scene.fixes}) list->front().body = "body";
  add_rigid_regions(scene);
  JointDescription hinge;
  hinge.name = "elbow";
  hinge.kind = JointKind::hinge;
  hinge.bodies = {"body.plate", "arm"};
  hinge.at = {0.5, 0.125, dimension == 3 ? 0.125 : 0.0};
  hinge.stiffness = 10;
  hinge.rest = 0.2;
  hinge.motor =
      MotorDescription{.position = 0.4, .velocity = {}, .effort = {}, .stiffness = 20, .time_function = {}};
  scene.joints.push_back(hinge);
  CableDescription cable;
  cable.name = "rope";
  cable.points = {{.body = "arm", .at = {0.9, 0.125, 0}}, on_ground({0.8, 0.7, 0})};
  cable.stiffness = 30;
  scene.cables.push_back(cable);
  scene.contact.is_enabled = false;
  return scene;
}

TEST(DerivativesOfJointsAndRigidBodies, AreRightAtRest) {
  for (const int dimension : {2, 3}) {
    SCOPED_TRACE(dimension);
    expect_right_derivatives(bar_with_arm(dimension, false));
  }
}

TEST(DerivativesOfJointsAndRigidBodies, AreRightForMotorsByTorqueAndForce) {
  Description scene = bar_with_arm(2, false);
  scene.joints[0].motor->effort = 3;
  expect_right_derivatives(scene, {"joint.elbow.motor.torque", "joint.elbow.rest"});
  scene.joints[0].kind = JointKind::slider;
  scene.joints[0].axis = {1, 0, 0};
  scene.joints[0].stiffness = 400;
  scene.joints[0].rest = 0.01;
  expect_right_derivatives(scene, {"joint.elbow.motor.force", "joint.elbow.stiffness", "joint.elbow.rest"});
}

TEST_P(CoupledDerivativesOfEveryIntegrator, AreRightForJointsAndRigidBodies) {
  Description scene = bar_with_arm(2, true);
  scene.integrator = integrator;
  scene.joints[0].motor->velocity = 3;
  expect_right_derivatives(scene);
}

/// The barrier of a rigid body follows the softest material that it meets, as that of a deformable one.
TEST(DerivativesOfJointsAndRigidBodies, AreRightInContact) {
  Description scene = short_bar(2, false);
  BodyDescription anvil;
  anvil.name = "anvil";
  anvil.mesh = make_rectangle({0.3, 0.1}, {1, 1});
  anvil.translate = {0.3, -0.125, 0};
  anvil.rigid = RigidDescription{.density = 300, .stiffness = 1e7};
  scene.bodies.push_back(anvil);
  scene.fixes.front().body = "body";
  for (LoadDescription& load : scene.loads) load.body = "body";
  FixDescription fix;
  fix.body = "anvil";
  fix.where.kind = Where::Kind::box;
  fix.where.min = {-1, -1, -1};
  fix.where.max = {1, 1, 1};
  scene.fixes.push_back(fix);
  scene.contact.is_enabled = true;
  scene.contact.activation_distance = 0.01;
  const Simulation simulation = run_all(scene);
  ASSERT_GT(simulation.frame().contact_energy, 0);
  expect_right_derivatives(scene);
}

/// Whatever follows a prescribed face moves with it, and the reactions of both are felt there.
TEST(DerivativesOfConstraints, AreRight) {
  for (const bool is_dynamic : {false, true}) {
    Description scene = short_bar(2, is_dynamic);
    ConstraintDescription equal;
    equal.name = "plane";
    equal.kind = ConstraintKind::equal;
    equal.where.kind = Where::Kind::box;
    equal.where.min = {0.4, -1, -1};
    equal.where.max = {1, 1, 1};
    equal.components = {true, false, false};
    equal.body = "body";
    scene.constraints.push_back(equal);
    ConstraintDescription link;
    link.name = "link";
    link.kind = ConstraintKind::equation;
    link.terms = {{.body = "body", .where = scene.fixes[0].where, .axis = 0, .coefficient = 1},
                  {.body = "body", .where = equal.where, .axis = 0, .coefficient = -2}};
    scene.constraints.push_back(link);
    scene.fixes[0].displacement = {0.02, 0.01, 0};
    if (is_dynamic) scene.fixes[0].velocity = {0.1, 0, 0};
    expect_right_derivatives(scene);
  }
}

TEST(DerivativesOfConstraints, AreRefusedByPlaces) {
  const Description scene = bar_with_arm(2, false);
  EXPECT_THAT([&] { Derivatives::run(scene, {"body.body.rest_positions"}); },
              ::testing::ThrowsMessage<InputError>(
                  HasSubstr("expected a scene without ties, constraints, joints and rigid regions")));
  Description damped = bar_with_arm(2, true);
  damped.joints[0].damping = 1;
  EXPECT_THAT([&] { Derivatives::run(damped, {"body.body.density"}); },
              ::testing::ThrowsMessage<InputError>(HasSubstr("no damper of a joint")));
}

INSTANTIATE_TEST_SUITE_P(Catalogue, CoupledDerivativesOfEveryIntegrator,
                         ::testing::ValuesIn(integrator_names()), name_of_integrator);

}  // namespace
}  // namespace resilin::testing
