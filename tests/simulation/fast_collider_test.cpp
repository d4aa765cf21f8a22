// Colliders that would be through a body within one step.

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
  const Conditions now{.time = state.time, .collider_delay = state.collider_delay};
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

}  // namespace
}  // namespace resilin::testing
