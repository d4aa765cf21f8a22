// Colliders that would be through a body within one step, and such as push it by many activation distances.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "resilin/contact/crossing.hpp"
#include "small_scenes.hpp"

namespace resilin::testing {
namespace {

using ::testing::HasSubstr;

/// A collider along -x towards the free end of the bar, its front 0.2 m away, wider than the bar.
ColliderDescription ram(const std::string& kind, int dim, double speed) {
  const Vector3 middle(0, 0.125, dim == 3 ? 0.125 : 0);
  ColliderDescription ram;
  ram.name = "ram";
  ram.kind = kind;
  ram.velocity = {-speed, 0, 0};
  ram.shape.normal = {-1, 0, 0};
  ram.shape.point = {1.2, 0, 0};
  ram.shape.radius = 0.4;
  ram.shape.center = middle + Vector3(kind == "sphere" ? 1.6 : 1.25, 0, 0);
  ram.shape.size = {0.1, 0.8, 0.8};
  ram.shape.start = middle + Vector3(1.6, -0.6, 0);
  ram.shape.end = middle + Vector3(1.6, 0.6, 0);
  return ram;
}

/// By distances and by exact predicates.
void expect_nothing_inside(const Simulation& simulation) {
  const State& state = simulation.state();
  const Conditions now{.time = state.time, .delay = state.collider_delay};
  for (const auto& collider : simulation.world().colliders)
    EXPECT_GT(collider->nearest(state.positions, now).distance, 0) << state.time;
  for (const auto& collider : simulation.world().mesh_colliders) {
    const ContactSurface& surface = collider->surface();
    const VectorX places = surface.places(state.positions, now);
    EXPECT_FALSE(first_crossing(surface.parts, collider->meetings(), places)) << state.time;
    const Index ram = surface.parts.bodies.back();
    for (Index body = 0; body < ram; ++body)
      EXPECT_FALSE(has_piece_inside(surface.parts, body, ram, places)) << state.time;
  }
}

class AFastCollider : public ::testing::TestWithParam<std::tuple<int, std::string, double>> {};
INSTANTIATE_TEST_SUITE_P(Family, AFastCollider,
                         ::testing::Combine(::testing::Values(2, 3),
                                            ::testing::Values("half_space", "sphere", "box", "capsule"),
                                            // 1.4, 6 and 2000 lengths of the bar in a step
                                            ::testing::Values(70.0, 300.0, 1e5)));

/// The bar is held, so that there is no room for it to be: it must wait in front of what is left of the bar.
TEST_P(AFastCollider, FallsBehindAndSaysSo) {
  const auto [dim, kind, speed] = GetParam();
  Description scene = small_bar(dim, true);
  scene.gravity.setZero();
  scene.end_time = 0.1;  // 5 steps
  scene.bodies[0].material.law = "neo_hookean";
  scene.colliders = {ram(kind, dim, speed)};
  Simulation simulation(scene);
  std::string said;
  while (!simulation.is_finished()) {
    const StepReport report = simulation.step();
    if (report.status != StepReport::Status::converged) said += report.reason;
    const State& state = simulation.state();
    ASSERT_TRUE(state.positions.allFinite());
    EXPECT_GT(simulation.frame().min_volume_ratio, 0);
    // Its front is where the delay says, before the wall that holds the bar: it has not come through.
    EXPECT_GT(1.2 - speed * (state.time - state.collider_delay), 0);
    expect_nothing_inside(simulation);
  }
  EXPECT_THAT(said, HasSubstr("behind its motion"));
}

struct Push {
  int iterations = 0;
  double largest_force = 0, last_force = 0;  ///< on the bodies, along -x [N]
};

/// Runs to the end; the last reaction is that of what pushes.
Push push_of(const Description& scene) {
  Simulation simulation(scene);
  Push push;
  while (!simulation.is_finished()) {
    const StepReport report = simulation.step();
    EXPECT_EQ(report.status, StepReport::Status::converged) << report.reason;
    EXPECT_EQ(simulation.state().collider_delay, 0);
    push.iterations += report.newton.iterations;
    push.last_force = -simulation.frame().reactions.back().second.x();
    push.largest_force = std::max(push.largest_force, push.last_force);
  }
  expect_nothing_inside(simulation);
  return push;
}

/// The bar is pressed by a fifth, at 32 activation distances in a step.
Description bar_to_push(int dim, bool is_dynamic) {
  Description scene = small_bar(dim, is_dynamic);
  scene.gravity.setZero();
  scene.load_steps = 10;
  scene.bodies[0].name = "bar";
  scene.bodies[0].material.law = "neo_hookean";
  scene.fixes[0].body = "bar";
  scene.probes.clear();
  return scene;
}

/// A piece of the bar's end in its place, so short that it does not buckle.
Description block_to_push(int dim, bool is_dynamic) {
  Description scene = bar_to_push(dim, is_dynamic);
  scene.bodies[0].mesh = dim == 3 ? make_box({0.25, 0.25, 0.25}, {2, 2, 2}, {0.75, 0, 0})
                                  : make_rectangle({0.25, 0.25}, {2, 2}, {0.75, 0});
  scene.fixes[0].where.at = 0.75;
  return scene;
}

class AColliderThatPushes : public ::testing::TestWithParam<std::tuple<int, bool>> {};
INSTANTIATE_TEST_SUITE_P(Family, AColliderThatPushes,
                         ::testing::Combine(::testing::Values(2, 3), ::testing::Bool()));

TEST_P(AColliderThatPushes, NeedsWhatAHeldBodyNeedsAndHasItsForce) {
  const auto [dim, is_dynamic] = GetParam();
  const Description alone = block_to_push(dim, is_dynamic);
  Description with_body = alone;
  BodyDescription tool;
  tool.name = "tool";
  tool.element = "P1";
  tool.mesh = dim == 3 ? make_box({0.1, 0.8, 0.8}, {1, 1, 1}, {1.2, -0.275, -0.275})
                       : make_rectangle({0.1, 0.8}, {1, 1}, {1.2, -0.275});
  with_body.bodies.push_back(tool);
  FixDescription held;
  held.name = "tool";
  held.body = "tool";
  held.where.kind = Where::Kind::all;
  (is_dynamic ? held.velocity : held.displacement) = {is_dynamic ? -1.25 : -0.25, 0, 0};
  with_body.fixes.push_back(held);
  const Push by_body = push_of(with_body);
  EXPECT_GT(by_body.largest_force, 0);
  for (const std::string kind : {"half_space", "box"}) {
    Description scene = alone;
    scene.colliders = {ram(kind, dim, is_dynamic ? 1.25 : 0)};
    if (!is_dynamic) scene.colliders[0].displacement = {-0.25, 0, 0};
    const Push push = push_of(scene);
    EXPECT_NEAR(push.last_force, by_body.last_force, 0.03 * by_body.largest_force) << kind;
    EXPECT_LT(push.iterations, 1.5 * by_body.iterations) << kind;
  }
}

/// A soft block is hit at the speed of its waves, in steps of 1.4 activation distances: the forces that throw
/// its nodes need gaps of a hundred thousandth of it.
TEST(AColliderThatHits, IsNeverBehind) {
  for (const std::string kind : {"half_space", "box", "cylinder"}) {
    SCOPED_TRACE(kind);
    Description scene = block_to_push(3, true);
    scene.bodies[0].material.constants["youngs_modulus"] = 5e4;
    scene.time_step = 1.75e-4;
    scene.end_time = 12 * scene.time_step;
    const double gap = 0.003, speed = 10, radius = 0.2;
    ColliderDescription tool = ram(kind, 3, speed);
    tool.shape.point.x() = 1 + gap;
    tool.shape.center.x() = 1 + gap + 0.5 * tool.shape.size.x();
    tool.shape.start.x() = tool.shape.end.x() = 1 + gap + radius;
    tool.shape.radius = radius;
    scene.colliders = {tool};
    const Push push = push_of(scene);
    EXPECT_GT(push.largest_force, 0);
  }
}

/// Round ones, too, and such as turn.
TEST_P(AColliderThatPushes, IsNeverBehind) {
  const auto [dim, is_dynamic] = GetParam();
  for (const std::string kind : {"sphere", "capsule", "box"}) {
    Description scene = bar_to_push(dim, is_dynamic);
    scene.colliders = {ram(kind, dim, is_dynamic ? 2 : 0)};
    if (!is_dynamic) scene.colliders[0].displacement = {-0.4, 0, 0};
    scene.colliders[0].friction = 0.3;
    if (kind == "box")
      scene.colliders[0].rotate =
          ColliderTurn{.axis = {0, 0, 1}, .center = {1.25, 0.125, 0}, .degrees_per_second = 50};
    const Push push = push_of(scene);
    EXPECT_GT(push.largest_force, 0) << kind;
    EXPECT_LT(push.iterations, 400) << kind;
  }
}

}  // namespace
}  // namespace resilin::testing
