// Bodies against half-spaces and balls, at rest and in motion.

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "every_integrator.hpp"
#include "resilin/world/colliders.hpp"
#include "same_bits.hpp"
#include "small_scenes.hpp"

namespace resilin::testing {
namespace {

ColliderDescription ground(int dimension) {
  ColliderDescription collider;
  collider.name = "ground";
  collider.shape.normal = Vector3::Unit(dimension - 1);
  return collider;
}

ColliderDescription ball(const Vector3& center, double radius) {
  ColliderDescription collider;
  collider.name = "ball";
  collider.kind = "sphere";
  collider.shape.center = center;
  collider.shape.radius = radius;
  return collider;
}

/// The small bar, free, turned a little and 2 cm above the ground.
Description dropped_bar(int dimension) {
  Description scene = small_bar(dimension, true);
  scene.fixes.clear();
  scene.bodies[0].rotate =
      Rotation{.axis = dimension == 3 ? Vector3(1, 2, 3) : Vector3(0, 0, 1), .degrees = 10};
  scene.bodies[0].translate = Vector3(0, 0, 0);
  scene.bodies[0].translate[dimension - 1] = dimension == 3 ? 0.15 : 0.02;
  scene.colliders = {ground(dimension)};
  scene.end_time = 0.8;
  return scene;
}

double smallest_distance(const Simulation& simulation) {
  double distance = std::numeric_limits<double>::infinity();
  const State& state = simulation.state();
  for (const auto& collider : simulation.world().colliders) {
    distance = std::min(
        distance,
        collider->nearest(state.positions, {.time = state.time, .delay = state.collider_delay}).distance);
  }
  return distance;
}

/// Held sideways everywhere, a cube of one hexahedron is a column: the barrier carries rho g h per area.
TEST(ACubeOnTheGround, RestsWhereTheBarrierCarriesItsWeight) {
  Description scene;
  scene.gravity = {0, 0, -9.81};
  BodyDescription body;
  body.mesh = make_hexahedron_box({1, 1, 1}, {1, 1, 1}, {0, 0, 0.004});
  body.element = "Q1";
  body.material.constants = {{"youngs_modulus", 1e6}, {"poissons_ratio", 0.3}};
  scene.bodies.push_back(body);
  FixDescription sides;
  sides.name = "sides";
  sides.components = {true, true, false};
  scene.fixes.push_back(sides);
  scene.colliders = {ground(3)};
  Simulation simulation = run_all(scene);
  ASSERT_TRUE(simulation.is_finished());
  const double weight = 9810;  // N
  EXPECT_EQ(simulation.frame().reactions[1].first, "ground");
  const Vector3 force = simulation.frame().reactions[1].second;
  EXPECT_NEAR(force.z(), weight, 1e-8 * weight);
  EXPECT_LT(force.head<2>().norm(), 1e-8 * weight);
  // The torque about the origin is that of the force at the middle of the base.
  EXPECT_LT((simulation.frame().reaction_torques[1] - Vector3(0.5 * weight, -0.5 * weight, 0)).norm(),
            1e-8 * weight);
  const ColliderBarrier& collider = *simulation.world().colliders[0];
  EXPECT_NEAR(collider.activation_distance(), 5e-3, 1e-15);
  const double gap = smallest_distance(simulation);
  const double pressure = -0.1 * 1e6 * ClampedLogBarrier{5e-3}.slope(gap);
  EXPECT_NEAR(pressure, weight, 1e-8 * weight);  // each corner has its share of one face
}

TEST(ABodyOnTheGround, NeverGainsEnergyByBackwardEuler) {
  for (const int dimension : {2, 3}) {
    Simulation simulation(dropped_bar(dimension));
    double last = simulation.frame().total_energy();
    bool has_touched = false;
    while (!simulation.is_finished()) {
      const StepReport report = simulation.step();
      EXPECT_EQ(report.status, StepReport::Status::converged) << report.reason;
      const Frame& frame = simulation.frame();
      // The tolerance of Newton's method leaves 1e-8 of the forces.
      EXPECT_LE(frame.total_energy(), last + 1e-6 * std::abs(last));
      EXPECT_GT(smallest_distance(simulation), 0);
      last = frame.total_energy();
      has_touched |= frame.contact_energy > 0;
    }
    EXPECT_TRUE(has_touched);
  }
}

/// In each step of backward Euler the forces are the change of momentum.
TEST(ABallPressedIntoABlock, FeelsWhatTheBlockFeels) {
  Description scene;
  scene.is_dynamic = true;
  scene.time_step = 1.0 / 60;
  scene.end_time = 0.5;
  BodyDescription body;
  body.element = "P1";
  body.mesh = make_box({1, 1, 0.5}, {6, 6, 3});
  scene.bodies.push_back(body);
  FixDescription foot;
  foot.name = "foot";
  foot.where.kind = Where::Kind::plane;
  foot.where.axis = 2;
  scene.fixes.push_back(foot);
  ColliderDescription collider = ball({0.5, 0.4, 0.92}, 0.4);
  collider.velocity = {0, 0, -1};  // 3.3 activation distances in a step
  collider.until = 0.2;
  scene.colliders.push_back(collider);
  Simulation simulation(scene);
  Vector3 momentum = Vector3::Zero();
  while (!simulation.is_finished()) {
    const StepReport report = simulation.step();
    ASSERT_EQ(report.status, StepReport::Status::converged) << report.reason;
    const Frame& frame = simulation.frame();
    const Vector3 change = (frame.linear_momentum - momentum) / scene.time_step;
    const Vector3 forces = frame.reactions[0].second + frame.reactions[1].second;
    EXPECT_LT((change - forces).norm(), 1e-6 * (1 + forces.norm() + frame.reactions[1].second.norm()));
    momentum = frame.linear_momentum;
    EXPECT_GT(smallest_distance(simulation), 0);
  }
  EXPECT_LT(simulation.frame().reactions[1].second.z(), -1000);  // N, down on the block
  EXPECT_EQ(simulation.state().collider_delay, 0);
}

TEST(RandomThrows, NeverPassThroughAGroundOrABall) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (int i = 0; i < 1000; ++i) {
    Description scene = small_bar(2, true);
    scene.fixes.clear();
    scene.probes.clear();
    scene.bodies[0].mesh = make_rectangle({0.5, 0.25}, {2, 1});
    scene.bodies[0].rotate = Rotation{.degrees = 180 * uniform(random)};
    scene.bodies[0].translate = {uniform(random), 0.6 + 0.02 * uniform(random), 0};
    scene.bodies[0].velocity = {10 * uniform(random), -10 + 10 * uniform(random), 0};
    scene.bodies[0].velocity_gradient(0, 1) = 5 * uniform(random);
    scene.colliders = {ground(2), ball({0.3, -1, 0}, 1.02 + 0.01 * uniform(random))};
    if (i % 4 == 0) scene.colliders[1].velocity = {0, 0.5, 0};
    scene.time_step = std::pow(10, -2 + uniform(random));
    scene.end_time = 4 * scene.time_step;
    scene.newton.max_iterations = i % 3 == 0 ? 1 : 50;
    Simulation simulation(scene);
    while (!simulation.is_finished()) {
      simulation.step();
      ASSERT_GT(smallest_distance(simulation), 0) << "throw " << i;
      ASSERT_TRUE(std::isfinite(simulation.frame().total_energy())) << "throw " << i;
    }
  }
}

struct EveryIntegratorOnTheGround : WithEveryIntegrator {};
INSTANTIATE_TEST_SUITE_P(Catalogue, EveryIntegratorOnTheGround, ::testing::ValuesIn(integrator_names()),
                         name_of_integrator);

TEST_P(EveryIntegratorOnTheGround, KeepsBodiesOutOfColliders) {
  Description scene = dropped_bar(2);
  scene.integrator = integrator;
  scene.end_time = 0.4;
  Simulation simulation(scene);
  double contact = 0;
  while (!simulation.is_finished()) {
    simulation.step();
    ASSERT_GT(smallest_distance(simulation), 0);
    contact = std::max(contact, simulation.frame().contact_energy);
  }
  EXPECT_GT(contact, 0);
  EXPECT_TRUE(std::isfinite(contact));
}

/// Two planes that pass through each other leave no room.
TEST(ABodyBetweenClosingPlanes, HoldsThemUpAndIsNotPierced) {
  Description scene = small_bar(2, true);
  scene.fixes.clear();
  scene.gravity.setZero();
  scene.bodies[0].mesh = make_rectangle({0.5, 0.25}, {2, 1}, {0, 0.01});
  ColliderDescription lid = ground(2);
  lid.name = "lid";
  lid.shape.point = {0, 0.3, 0};
  lid.shape.normal = {0, -1, 0};
  lid.velocity = {0, -1, 0};
  scene.colliders = {ground(2), lid};
  scene.end_time = 0.4;
  Simulation simulation(scene);
  std::string reason;
  while (!simulation.is_finished()) {
    const StepReport report = simulation.step();
    if (report.status == StepReport::Status::not_converged) reason = report.reason;
    ASSERT_GT(smallest_distance(simulation), 0);
    ASSERT_GT(simulation.frame().min_volume_ratio, -1);
  }
  EXPECT_NE(reason.find("behind its motion"), reason.npos) << reason;
  EXPECT_GT(simulation.state().collider_delay, 0.05);
}

TEST(ABodyOnTheGround, MovesInTheSameBitsForAnyNumberOfThreadsAndAfterARestart) {
  Description scene = dropped_bar(3);
  scene.end_time = 0.3;
  ColliderDescription pusher = ball({0.3, 0.1, 0.9}, 0.3);
  pusher.velocity = {0, 0, -1};
  scene.colliders.push_back(pusher);
  expect_same_bits_for_any_number_of_threads(scene);
  expect_same_bits_after_a_checkpoint(scene, 7);
}

TEST(ABodyInsideACollider, IsRefusedWithItsDeepestVertex) {
  Description scene = small_bar(3, true);
  scene.colliders = {ball({1, 0.25, 0.25}, 0.02)};
  EXPECT_EQ(refusal_of(scene),
            "collider: expected bodies that start outside, with a gap, got vertex 80 of \"body\" at (1, "
            "0.25, 0.25), "
            "0.02 m inside; move the body (translate) or the collider by 0.0225 m or more");
  scene.colliders = {ground(3)};
  EXPECT_NE(refusal_of(scene).find(", on its surface; move"), std::string::npos);
  // A vertex that a support holds is where it is.
  scene.fixes[0].where.axis = 2;
  EXPECT_EQ(refusal_of(scene), "");
}

TEST(AStaticBodyOnTheGround, IsNotHeldSideways) {
  Description scene = small_bar(3, false);
  scene.fixes.clear();
  scene.bodies[0].translate = {0, 0, 0.001};
  scene.colliders = {ground(3)};
  const std::string message = refusal_of(scene);
  EXPECT_NE(message.find("3 of 6 rigid-body motions are free in a static analysis: translation along x, "
                         "translation along y, rotation about z;"),
            message.npos)
      << message;
  EXPECT_NE(message.find("constrains a body only within the activation distance"), message.npos);
  scene.bodies[0].translate = {0, 0, 0.1};
  EXPECT_NE(refusal_of(scene).find("6 of 6 rigid-body motions"), std::string::npos);
}

TEST(FreeVibrations, RefuseColliders) {
  Description scene = small_bar(3, false);
  scene.modes.emplace();
  scene.colliders = {ball({5, 0, 0}, 1)};
  EXPECT_NE(refusal_of(scene).find("no [[collider]] in a modal analysis"), std::string::npos);
}

}  // namespace
}  // namespace resilin::testing
