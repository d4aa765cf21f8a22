// Functions of time in a static run, where the load factor is the path parameter.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "resilin/core/error.hpp"
#include "small_scenes.hpp"

namespace resilin::testing {
namespace {

/// A bar under two tractions on its end, one along x and one along y.
Description pulled_bar() {
  Description scene = small_bar(3, false);
  scene.gravity.setZero();
  scene.end_time = 1;
  for (const Vector3& value : {Vector3(2000, 0, 0), Vector3(0, 300, 0)}) {
    LoadDescription load;
    load.kind = "traction";
    load.where.kind = Where::Kind::plane;
    load.where.at = 1;
    load.value = value;
    scene.loads.push_back(load);
  }
  scene.loads[0].name = "first";
  scene.loads[1].name = "second";
  return scene;
}

Vector3 tip(const Simulation& simulation) { return simulation.frame().probes[0].displacement; }

TEST(APathParameter, BringsOneLoadBeforeAnother) {
  Description only_first = pulled_bar();
  only_first.loads.pop_back();
  const Vector3 after_first = tip(converged_end_of(only_first));
  const Vector3 after_both = tip(converged_end_of(pulled_bar()));

  for (const double end_time : {2.0, 2e3}) {
    Description scene = pulled_bar();
    scene.end_time = end_time;
    scene.load_steps = 3;
    scene.loads[0].time_function.form = TimeFunction::Ramp{.from = 0, .until = 0.5 * end_time};
    scene.loads[1].time_function.form = TimeFunction::Ramp{.from = 0.5 * end_time, .until = end_time};
    Simulation simulation(scene);
    bool has_met_the_knot = false;
    while (!simulation.is_finished()) {
      ASSERT_EQ(simulation.step().status, StepReport::Status::converged);
      EXPECT_NEAR(simulation.frame().time, simulation.frame().load * end_time, 1e-12 * end_time);
      if (simulation.frame().load != 0.5) continue;
      has_met_the_knot = true;
      EXPECT_LT((tip(simulation) - after_first).norm(), 1e-7 * after_first.norm());
    }
    EXPECT_TRUE(has_met_the_knot);
    EXPECT_LT((tip(simulation) - after_both).norm(), 1e-7 * after_both.norm());
  }
}

/// Windows, velocities and functions of supports and springs see the same time as functions of loads do.
TEST(APathParameter, IsTheTimeOfWindowsVelocitiesAndSupports) {
  Description moved = pulled_bar();
  moved.loads[0].from = 0.25;
  moved.loads[1].until = 0.75;
  FixDescription end = moved.fixes[0];
  end.name = "end";
  end.where.at = 1;
  end.components = {false, false, true};
  end.velocity = {0, 0, 0.1};
  end.until = 0.5;
  moved.fixes.push_back(end);
  Description still = pulled_bar();
  still.loads.pop_back();
  end.velocity.setZero();
  end.until.reset();
  end.displacement = {0, 0, 0.05};
  still.fixes.push_back(end);
  const Vector3 expected = tip(converged_end_of(still));
  EXPECT_LT((tip(converged_end_of(moved)) - expected).norm(), 1e-7 * expected.norm());

  moved.fixes[1] = end;
  moved.fixes[1].displacement = {0, 0, 0.1};
  moved.fixes[1].time_function.form = TimeFunction::Table{.times = {0, 0.5, 1}, .values = {0, 3, 0.5}};
  EXPECT_LT((tip(converged_end_of(moved)) - expected).norm(), 1e-7 * expected.norm());

  Description sprung = small_bar(3, false);
  sprung.end_time = 1;
  LoadDescription spring;
  spring.kind = "spring";
  spring.where.kind = Where::Kind::plane;
  spring.where.at = 1;
  spring.stiffness = 100;
  spring.velocity = {0, 0.2, 0};
  sprung.loads.push_back(spring);
  const Vector3 by_velocity = tip(converged_end_of(sprung));
  sprung.loads[0].displacement = sprung.loads[0].velocity;
  sprung.loads[0].velocity.setZero();
  EXPECT_LT((tip(converged_end_of(sprung)) - by_velocity).norm(), 1e-7 * by_velocity.norm());
}

/// A column held sideways is pressed by a plane that comes down on it by 0.1 m: it carries the same force all
/// along, and its head is where the plane is, but for the gap of the barrier.
TEST(ACollider, MovesAlongThePathOfAStaticRun) {
  Description scene;
  BodyDescription body;
  body.mesh = make_hexahedron_box({1, 1, 1}, {1, 1, 4});
  body.element = "Q1";
  body.material.constants = {{"youngs_modulus", 1e6}, {"poissons_ratio", 0.3}};
  scene.bodies.push_back(body);
  FixDescription sides;
  sides.name = "sides";
  sides.components = {true, true, false};
  scene.fixes.push_back(sides);
  FixDescription foot;
  foot.name = "foot";
  foot.where.kind = Where::Kind::plane;
  foot.where.axis = 2;
  foot.components = {false, false, true};
  scene.fixes.push_back(foot);
  ColliderDescription plane;
  plane.name = "plane";
  plane.shape.point = {0, 0, 1.01};
  plane.shape.normal = {0, 0, -1};
  plane.velocity = {0, 0, -0.055};
  plane.until = 2;
  scene.colliders.push_back(plane);
  scene.end_time = 4;
  Simulation simulation(scene);
  bool has_met_the_end_of_the_motion = false;
  while (!simulation.is_finished()) {
    ASSERT_EQ(simulation.step().status, StepReport::Status::converged);
    has_met_the_end_of_the_motion |= simulation.frame().time == 2;
  }
  EXPECT_TRUE(has_met_the_end_of_the_motion);
  const Frame& frame = simulation.frame();
  const double pressed = -frame.reactions[2].second.z(), carried = frame.reactions[1].second.z();
  EXPECT_NEAR(pressed, carried, 1e-7 * carried);
  EXPECT_GT(carried, 1e5);
  double head = 0;
  for (Eigen::Index i = 2; i < simulation.state().positions.size(); i += 3)
    head = std::max(head, simulation.state().positions[i]);
  EXPECT_LT(head, 0.9);
  EXPECT_GT(head, 0.9 - 5e-3);  // within the activation distance
}

TEST(AStaticRun, SaysWhatItDoesNotReachAndRefusesWhatItCannot) {
  Description scene = pulled_bar();
  scene.loads[0].time_function.form = TimeFunction::Ramp{.from = 0, .until = 3};
  EXPECT_THAT(World(scene).warnings, ::testing::ElementsAre(::testing::HasSubstr("change until 3 s")));
  scene.load_control = LoadControlKind::arc_length;
  EXPECT_THROW(World{scene}, InputError);
}

}  // namespace
}  // namespace resilin::testing
