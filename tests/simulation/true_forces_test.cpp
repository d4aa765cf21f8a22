// Forces and velocities of what rests, by every integrator: no swing of a scheme is among them.

#include <gtest/gtest.h>

#include <cmath>

#include "every_integrator.hpp"
#include "small_scenes.hpp"

namespace resilin::testing {
namespace {

constexpr double g = 9.81, side = 0.2, density = 1000;
constexpr double weight_2d = density * side * side * g;  // N on unit depth

/// A block of 0.2 m, half an activation distance above what it will rest on.
BodyDescription block_at(double height, const DampingDescription& damping) {
  BodyDescription body;
  body.element = "P1";
  body.mesh = make_rectangle({side, side}, {2, 2});
  body.material.constants = {{"youngs_modulus", 1e6}, {"poissons_ratio", 0.3}};
  body.damping = damping;
  body.translate.y() = height;
  return body;
}

Description resting(const std::string& integrator, const DampingDescription& damping, double slope = 0) {
  Description scene;
  scene.dimension = 2;
  scene.is_dynamic = true;
  scene.integrator = integrator;
  scene.time_step = 0.01;
  scene.end_time = 1;
  const double angle = std::atan(slope);
  scene.gravity = g * Vector3(std::sin(angle), -std::cos(angle), 0);
  scene.bodies.push_back(block_at(0.5e-3, damping));
  return scene;
}

ColliderDescription floor_of(const std::string& kind, double friction) {
  ColliderDescription floor;
  floor.name = "floor";
  floor.kind = kind;
  floor.shape.normal = Vector3::UnitY();
  floor.shape.center = {0.1, -0.1, 0};
  floor.shape.size = {2, 0.2, 0};
  floor.friction = friction;
  return floor;
}

std::string damping_text(const DampingDescription& damping) {
  return ", damping of mass " + std::to_string(damping.mass) + ", of stiffness " +
         std::to_string(damping.stiffness);
}

double speed(const Frame& frame, double mass) { return std::sqrt(2 * frame.kinetic_energy / mass); }

/// Runs to the end. @return the mean force of what has this number among the reactions, over the last half
/// [N]
/// Means from 0.5 s on [N].
struct MeanForces {
  Vector3 reaction = Vector3::Zero(), contact = Vector3::Zero();
};

MeanForces mean_forces(Simulation& simulation, std::size_t number) {
  MeanForces sum;
  int count = 0;
  while (!simulation.is_finished()) {
    EXPECT_EQ(simulation.step().status, StepReport::Status::converged);
    if (simulation.state().time < 0.5) continue;
    const Frame& frame = simulation.frame();
    sum.reaction += frame.reactions[number].second;
    if (!frame.contacts.empty()) sum.contact += frame.contacts[0].force;
    ++count;
  }
  return {sum.reaction / count, sum.contact / count};
}

Vector3 mean_reaction(Simulation& simulation, std::size_t number) {
  return mean_forces(simulation, number).reaction;
}

struct WhatRests : WithEveryIntegrator {
  /// None, of the mass, and of the stiffness, which leaves rigid motion alone.
  std::vector<DampingDescription> dampings() const { return {{}, {.mass = 40}, {.stiffness = 0.02}}; }
  /// These keep the vibrations of contacts for long: the mean force is true, and speeds are small.
  bool keeps_vibrations() const { return integrator == "newmark" || integrator == "midpoint"; }
  double tolerance() const { return keeps_vibrations() ? 2e-2 : 2e-3; }
  double still() const { return keeps_vibrations() ? 3e-2 : 1e-3; }  ///< [m/s]
};
INSTANTIATE_TEST_SUITE_P(Catalogue, WhatRests, ::testing::ValuesIn(integrator_names()), name_of_integrator);

TEST_P(WhatRests, HasItsWeightAsReactionAndNoVelocity) {
  for (const std::string kind : {"half_space", "box"})
    for (const DampingDescription& damping : dampings()) {
      SCOPED_TRACE(kind + damping_text(damping));
      Description scene = resting(integrator, damping);
      scene.colliders.push_back(floor_of(kind, 0.3));
      Simulation simulation(scene);
      EXPECT_NEAR(mean_reaction(simulation, 0).y(), weight_2d, 2e-3 * weight_2d);
      EXPECT_LT(speed(simulation.frame(), weight_2d / g), still());
    }
}

TEST_P(WhatRests, PressesTheBodyBelowByItsWeight) {
  for (const DampingDescription& damping : dampings()) {
    SCOPED_TRACE(damping_text(damping));
    Description scene = resting(integrator, damping);
    scene.bodies.push_back(block_at(side + 1e-3, damping));
    scene.bodies[0].name = "lower";
    scene.bodies[1].name = "upper";
    scene.contact.friction = 0.3;
    scene.colliders.push_back(floor_of("half_space", 0.3));
    Simulation simulation(scene);
    const MeanForces mean = mean_forces(simulation, 0);
    EXPECT_NEAR(mean.reaction.y(), 2 * weight_2d, tolerance() * 2 * weight_2d);
    const Frame& frame = simulation.frame();
    ASSERT_EQ(frame.contacts.size(), 1U);
    const bool is_damped = damping.mass + damping.stiffness > 0;  // else the bodies still vibrate
    EXPECT_LT(speed(frame, 2 * weight_2d / g), is_damped ? still() : 3e-2);
    if (!keeps_vibrations()) {
      const double force = is_damped ? frame.contacts[0].force.y() : mean.contact.y();
      EXPECT_NEAR(force, weight_2d, (is_damped ? 2e-3 : 1e-2) * weight_2d);
    }
  }
}

TEST_P(WhatRests, PullsItsSupportByItsWeight) {
  for (const DampingDescription& damping : dampings()) {
    SCOPED_TRACE(damping_text(damping));
    Description scene = resting(integrator, damping);
    FixDescription foot;
    foot.name = "foot";
    foot.where.kind = Where::Kind::plane;
    foot.where.axis = 1;
    foot.where.at = 0.5e-3;
    scene.fixes.push_back(foot);
    Simulation simulation(scene);
    EXPECT_NEAR(mean_reaction(simulation, 0).y(), weight_2d, 2e-2 * weight_2d);
  }
}

/// On a slope that friction only just holds: both parts of the force, and a creep below the friction speed.
TEST_P(WhatRests, SticksToASlope) {
  constexpr double slope = 0.3249;
  for (const DampingDescription& damping : dampings()) {
    if (keeps_vibrations() && damping.mass + damping.stiffness == 0) continue;  // hops on, and down the slope
    SCOPED_TRACE(damping_text(damping));
    Description scene = resting(integrator, damping, slope);
    scene.colliders.push_back(floor_of("half_space", 0.34));
    Simulation simulation(scene);
    const Vector3 pull = weight_2d / g * scene.gravity;
    EXPECT_LT((mean_reaction(simulation, 0) + pull).norm(), 5e-3 * pull.norm());
    EXPECT_LT(speed(simulation.frame(), weight_2d / g), still());
  }
}

/// Whatever damps it: friction is that of the weight, and its heat the energy that it takes, in every step.
TEST_P(WhatRests, SlidesByCoulombsLaw) {
  for (const DampingDescription& damping : {DampingDescription{}, DampingDescription{.stiffness = 0.02}}) {
    SCOPED_TRACE(damping_text(damping));
    Description scene = resting(integrator, damping);
    scene.colliders.push_back(floor_of("half_space", 0.3));
    scene.bodies[0].velocity = {2, 0, 0};
    Simulation simulation(scene);
    const double start = simulation.frame().kinetic_energy;
    double heat = 0;
    for (int step = 0; step < 30; ++step) {
      simulation.step();
      const Frame& frame = simulation.frame();
      const Vector3& force = frame.reactions[0].second;
      EXPECT_NEAR(force.x(), -0.3 * force.y(), 1e-6 * weight_2d);
      EXPECT_GE(frame.friction_work, heat);
      heat = frame.friction_work;
    }
    const double speed_left = simulation.frame().linear_momentum.x() * g / weight_2d;
    EXPECT_NEAR(speed_left, 2 - 0.3 * g * 0.3, 3e-3);
    EXPECT_NEAR(heat, start - 0.5 * weight_2d / g * speed_left * speed_left, 0.012 * start);
  }
}

}  // namespace
}  // namespace resilin::testing
