// Scenes that somebody takes up from a state that a run has left.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "playground.hpp"
#include "resilin/core/error.hpp"
#include "resilin/live/played_otherwise.hpp"
#include "rubbing_scenes.hpp"
#include "small_scenes.hpp"

namespace resilin::testing {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

struct TakenUp {
  std::string name;
  Description scene;
  int steps;  ///< steps of the run
};

/// A bar that falls and slides on a floor, whose barrier is the scene's own, behind a ball that pushes it.
Description pushed_bar(int dimension, const std::string& element) {
  Description scene = small_bar(dimension, true);
  scene.bodies[0].element = element;
  scene.bodies[0].velocity = {0.3, 0, 0};
  scene.fixes.clear();
  const Vector3 up = -scene.gravity.normalized();
  ColliderDescription floor;
  floor.name = "floor";
  floor.shape.point = -0.004 * up;
  floor.shape.normal = up;
  floor.friction = 0.3;
  floor.activation_distance = 0.01;
  floor.stiffness = 3e4;
  ColliderDescription ball;
  ball.name = "ball";
  ball.kind = "sphere";
  ball.shape.center = Vector3(-0.26, 0.125, dimension == 3 ? 0.125 : 0.0);
  ball.shape.radius = 0.25;
  ball.displacement = {0.1, 0, 0};
  ball.time_function.form = TimeFunction::Sine{.frequency = 2};
  scene.colliders = {floor, ball};
  scene.contact.friction_iterations = 50;
  return scene;
}

std::vector<TakenUp> motions() {
  std::vector<TakenUp> all;
  for (const int dimension : {2, 3}) {
    const std::string d = std::to_string(dimension) + "D";
    all.push_back({"bar in " + d, small_bar(dimension, true), 4});
    for (const std::string element : {"P1", "P2"})
      all.push_back({"pushed bar in " + d + ", " + element, pushed_bar(dimension, element), 6});
    all.push_back({"rubbing bars in " + d, rubbing_bars(dimension, true, "half_space"), 3});
    Description pulled = small_bar(dimension, true);
    LoadDescription load;
    load.kind = "traction";
    load.where.kind = Where::Kind::plane;
    load.where.at = 1;
    load.value = Vector3::Constant(100);
    load.time_function.form = TimeFunction::Ramp{.from = 0.05, .until = 0.2};
    pulled.loads.push_back(load);
    FixDescription& wall = pulled.fixes[0];
    wall.displacement = {0.05, 0, 0};
    wall.time_function.form = TimeFunction::Sine{.frequency = 3};
    all.push_back({"shaken bar in " + d, pulled, 5});
  }
  return all;
}

TEST(TakenUpScene, HasCollidersWhereBodiesHaveHeldThemUp) {
  const Description scene = bar_before_a_fast_ball();
  Simulation run(scene);
  while (run.state().collider_delay == 0 && !run.is_finished()) ASSERT_TRUE(run.step().has_solution);
  const State before = run.state();
  ASSERT_GT(before.collider_delay, 0);
  LiveScene live(scene, before);
  EXPECT_EQ(live.conditions().delay, before.collider_delay);
  // No way back, and none through the bar in between.
  const auto clock = [](const Conditions& c) { return c.time - c.delay; };
  for (int step = 0; step < 3; ++step) {
    const double at = clock(live.conditions());
    live.step(unhurried);
    EXPECT_GE(clock(live.conditions()), at);
    EXPECT_GT(live.world().colliders[0]->nearest(live.state().positions, live.conditions()).distance, 0);
  }
}

/// The first step by hand is the step that the run takes next, as far as both are solved.
TEST(TakenUpScene, GoesOnAsTheRunDoes) {
  for (auto& [name, scene, steps] : motions()) {
    SCOPED_TRACE(name);
    Simulation run(scene);
    for (int step = 0; step < steps; ++step) ASSERT_EQ(run.step().reason, "");
    const State before = run.state();
    LiveScene live(scene, before);
    EXPECT_EQ(live.state().positions, before.positions);
    EXPECT_EQ(live.conditions().time, before.time);
    EXPECT_EQ(live.conditions().delay, before.collider_delay);
    LiveControls exact = live.controls();
    exact.tolerance = 1e-8;
    live.set_controls(exact);
    for (int step = 0; step < 2; ++step) {
      ASSERT_EQ(run.step().reason, "");
      live.step(unhurried);
      const double moved = (run.state().positions - before.positions).norm();
      EXPECT_LE((live.state().positions - run.state().positions).norm(), 1e-6 * moved);
      EXPECT_NEAR(live.state().time, run.state().time, 1e-15);
    }
    live.reset();
    EXPECT_EQ(live.state().positions, before.positions);
    EXPECT_EQ(live.state().velocities, before.velocities);
    EXPECT_EQ(live.state().time, before.time);
    EXPECT_THAT(played_otherwise(scene), ElementsAre());
  }
}

/// Cells that a run has turned inside out move as their law says, until somebody lays hand on them.
TEST(TakenUpScene, GoesOnWithCellsInsideOutAsTheRunDoes) {
  Description scene = small_bar(3, true);
  scene.gravity.setZero();
  scene.bodies[0].material.law = "stable_neo_hookean";
  scene.bodies[0].velocity_gradient = Vector3(-60, 0, 0).asDiagonal();
  Simulation run(scene);
  while (run.frame().min_volume_ratio > 0 && !run.is_finished()) ASSERT_EQ(run.step().reason, "");
  ASSERT_LT(run.frame().min_volume_ratio, 0);
  const State before = run.state();
  LiveScene live(scene, before), pulled(scene, before);
  LiveControls exact = live.controls();
  exact.tolerance = 1e-8;
  live.set_controls(exact);
  pulled.set_controls(exact);
  pulled.grab(at_node(0), live.world().place_of(0, before.positions));
  pulled.release();
  ASSERT_EQ(run.step().reason, "");
  live.step(unhurried);
  pulled.step(unhurried);
  const double moved = (run.state().positions - before.positions).norm();
  EXPECT_LE((live.state().positions - run.state().positions).norm(), 1e-6 * moved);
  EXPECT_GT((pulled.state().positions - run.state().positions).norm(), 1e-2 * moved);
}

/// A run at rest under a part of its load stays at rest by hand.
TEST(TakenUpScene, OfARunAtRestRestsUnderTheLoadOfItsFrame) {
  Description scene = small_bar(3, false);
  scene.load_steps = 4;
  FixDescription turned = scene.fixes[0];
  turned.name = "turned";
  turned.where.at = 1;
  turned.rotate = Rotation{.axis = {1, 0, 0}, .center = {0, 0.125, 0.125}, .degrees = 150};
  scene.fixes.push_back(turned);
  Simulation run(scene);
  for (int step = 0; step < 2; ++step) ASSERT_EQ(run.step().reason, "");
  ASSERT_EQ(run.state().load, 0.5);
  LiveScene live(scene, run.state());
  EXPECT_EQ(live.conditions().load, 0.5);
  for (int step = 0; step < 400 && !live.report().at_rest; ++step) live.step(unhurried);
  EXPECT_TRUE(live.report().at_rest);
  const double sag = (run.state().positions - run.world().rest_positions).norm();
  EXPECT_LT((live.state().positions - run.state().positions).norm(), 1e-6 * sag);
  EXPECT_THAT(played_otherwise(scene), ElementsAre(HasSubstr("at the load factor of the frame")));
}

/// Loads that follow a path go on along it, to its end.
TEST(TakenUpScene, OfAPathGoesOnAlongIt) {
  Description scene = small_bar(2, false);
  scene.load_steps = 4;
  scene.fixes[0].velocity = {0.05, 0, 0};
  Simulation run(scene);
  for (int step = 0; step < 2; ++step) ASSERT_EQ(run.step().reason, "");
  LiveScene live(scene, run.state());
  EXPECT_EQ(live.conditions().time, run.state().time);
  EXPECT_DOUBLE_EQ(live.conditions().load, 0.5);
  while (live.state().time < 1.5 * scene.end_time) live.step(unhurried);
  EXPECT_EQ(live.conditions().load, 1);
  EXPECT_EQ(live.conditions().time, scene.end_time);
  for (int step = 0; step < 3000 && !live.report().at_rest; ++step) live.step(unhurried);
  const Simulation end = converged_end_of(scene);
  const double moved = (end.state().positions - end.world().rest_positions).norm();
  EXPECT_LT((live.state().positions - end.state().positions).norm(), 1e-6 * moved);
  EXPECT_THAT(played_otherwise(scene), ElementsAre(HasSubstr("along their path")));
}

TEST(TakenUpScene, SaysWhatItsStepsDoOtherwise) {
  Description scene = small_bar(2, true);
  scene.integrator = "newmark";
  scene.bodies[0].mass = MassKind::consistent;
  EXPECT_THAT(played_otherwise(scene),
              ElementsAre("backward Euler's steps of 0.02 s in place of those of newmark",
                          "masses are lumped, not consistent"));
  scene.adaptive = AdaptiveSteps{};
  EXPECT_THAT(played_otherwise(scene)[0], HasSubstr("in place of adaptive ones of newmark"));
}

TEST(TakenUpScene, RefusesAStateOfAnotherMeshOrWithoutNumbers) {
  const Description scene = small_bar(2, true);
  State state = Simulation(scene).state();
  state.positions[0] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(LiveScene(scene, state), InputError);
  EXPECT_THROW(LiveScene(small_bar(3, true), Simulation(scene).state()), InputError);
}

}  // namespace
}  // namespace resilin::testing
