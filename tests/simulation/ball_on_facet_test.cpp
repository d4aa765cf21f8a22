// Balls that are small beside the facets of a body.

#include <gtest/gtest.h>

#include <cmath>

#include "every_integrator.hpp"
#include "small_scenes.hpp"

namespace resilin::testing {
namespace {

constexpr double radius_of_ball = 0.03;  // m

/// A block of 0.2 m, one cell along each side, its foot held, with a ball just above the middle of a facet of
/// its top. No node is nearer to the ball than twice its radius.
Description block_under_a_ball(int dimension, const std::string& element, bool is_dynamic) {
  Description scene;
  scene.dimension = dimension;
  scene.is_dynamic = is_dynamic;
  const int up = dimension - 1;
  BodyDescription body;
  body.element = element;
  const bool is_bilinear = element.starts_with("Q");
  if (dimension == 3) {
    const Vector3 size = Vector3::Constant(0.2);
    body.mesh = is_bilinear ? make_hexahedron_box(size, {1, 1, 1}) : make_box(size, {1, 1, 1});
  } else {
    body.mesh =
        is_bilinear ? make_quadrilateral_rectangle({0.2, 0.2}, {1, 1}) : make_rectangle({0.2, 0.2}, {1, 1});
  }
  scene.bodies.push_back(body);
  FixDescription foot;
  foot.name = "foot";
  foot.where.kind = Where::Kind::plane;
  foot.where.axis = up;
  scene.fixes.push_back(foot);
  ColliderDescription ball;
  ball.name = "ball";
  ball.kind = "sphere";
  ball.shape.radius = radius_of_ball;
  ball.shape.center = (dimension == 3 ? Vector3(0.12, 0.06, 0) : Vector3(0.08, 0, 0));
  ball.shape.center[up] = 0.2 + radius_of_ball + 0.0009;
  ball.friction = 0.3;
  scene.colliders.push_back(ball);
  return scene;
}

double smallest_gap(const Simulation& simulation) {
  const State& state = simulation.state();
  const Conditions now{.time = state.time, .load = state.load, .delay = state.collider_delay};
  return simulation.world().colliders[0]->gap(state.positions, now);
}

struct ABallOnAFacet : ::testing::TestWithParam<std::pair<int, std::string>> {
  const int dimension = GetParam().first;
  const std::string element = GetParam().second;
  Description scene(bool is_dynamic) const { return block_under_a_ball(dimension, element, is_dynamic); }
};
INSTANTIATE_TEST_SUITE_P(Elements, ABallOnAFacet,
                         ::testing::Values(std::pair{3, "P1"}, std::pair{3, "P2"}, std::pair{3, "Q1"},
                                           std::pair{2, "P1"}, std::pair{2, "P2"}, std::pair{2, "Q1"}),
                         [](const auto& entry) {
                           return entry.param.second + "_" + std::to_string(entry.param.first) + "d";
                         });

/// Pressed in and along: the block's foot bears what the ball exerts.
TEST_P(ABallOnAFacet, PressesItInStatics) {
  Description pressed = scene(false);
  Vector3& way = pressed.colliders[0].displacement;
  way[dimension - 1] = -0.01;
  way[0] = 0.002;
  pressed.load_steps = 20;
  const Simulation simulation = converged_end_of(pressed);
  const Vector3 foot = simulation.frame().reactions[0].second, ball = simulation.frame().reactions[1].second;
  EXPECT_LT(ball[dimension - 1], -1);  // N
  EXPECT_LT((foot + ball).norm(), 1e-6 * ball.norm());
  EXPECT_GT(simulation.frame().friction_work, 0);
  EXPECT_GT(smallest_gap(simulation), 0);
}

/// A block that is thrown at it loses its way and turns about the ball.
TEST_P(ABallOnAFacet, StopsItInMotion) {
  Description thrown = scene(true);
  thrown.fixes.clear();
  BodyDescription& block = thrown.bodies[0];
  block.velocity[dimension - 1] = 2;
  block.translate[dimension - 1] = -0.005;
  thrown.time_step = 0.002;
  thrown.end_time = 0.03;
  Simulation simulation(thrown);
  const double first = simulation.frame().linear_momentum[dimension - 1];
  double last = first;
  while (!simulation.is_finished()) {
    const StepReport report = simulation.step();
    ASSERT_EQ(report.status, StepReport::Status::converged) << report.reason;
    ASSERT_GT(smallest_gap(simulation), 0);
    last = simulation.frame().linear_momentum[dimension - 1];
  }
  EXPECT_LT(last, 0.2 * first);
}

/// A ball that moves through the block pushes it along.
TEST_P(ABallOnAFacet, PushesItAlong) {
  Description pushed = scene(true);
  pushed.fixes.clear();
  pushed.colliders[0].velocity = -Vector3::Unit(dimension - 1);
  pushed.end_time = 0.3;
  Simulation simulation(pushed);
  while (!simulation.is_finished()) {
    simulation.step();
    ASSERT_GT(smallest_gap(simulation), 0);
  }
  EXPECT_LT(simulation.frame().linear_momentum[dimension - 1], 0);
}

TEST(ABallThatStartsInAFacet, IsRefused) {
  Description scene = block_under_a_ball(3, "P1", false);
  scene.colliders[0].shape.center.z() = 0.2 + radius_of_ball - 0.0001;
  EXPECT_FALSE(refusal_of(scene).empty());
  scene.colliders[0].shape.center.z() = 0.2 + radius_of_ball + 0.0001;
  EXPECT_EQ(refusal_of(scene), "");
}

}  // namespace
}  // namespace resilin::testing
