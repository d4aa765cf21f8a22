// The plan of a stage: under which conditions it is solved, and where its fixed unknowns go.

#include "resilin/simulation/stage_plan.hpp"

#include <gtest/gtest.h>

#include "every_integrator.hpp"
#include "resilin/integrator/stage_sequence.hpp"
#include "small_scenes.hpp"

namespace resilin::testing {
namespace {

/// A bar whose wall moves on at an even speed and swings.
Description led_bar(bool is_dynamic) {
  Description scene = small_bar(3, is_dynamic);
  scene.fixes[0].displacement = {0, 0, 0.02};
  scene.fixes[0].time_function = TimeFunction{TimeFunction::Sine{.frequency = 3, .phase = 30}};
  scene.fixes[0].velocity = {0.1, 0, 0};
  return scene;
}

TEST(PlanOfAnIncrement, LeadsSupportsAndHasTheWayOfCollidersBeforeIt) {
  const World world(led_bar(false));
  const StagePlan plan = plan_increment(world, world.start_positions, 0.25, 0.75);
  EXPECT_EQ(plan.conditions.load, 0.75);
  EXPECT_EQ(plan.conditions.time, world.at_load(0.75).time);
  EXPECT_EQ(plan.conditions.delay, world.at_load(0.75).time - world.at_load(0.25).time);
  EXPECT_GT(plan.conditions.delay, 0) << "the wall follows time";
  EXPECT_TRUE(plan.stage.is_static());
  EXPECT_EQ(plan.stage.load_time, 0.5 * world.end_time);
  EXPECT_EQ(plan.stage.base_positions, world.start_positions);
  VectorX expected = world.start_positions;
  place_supports(world.dimension, world.supports, world.rest_positions, plan.conditions, expected);
  EXPECT_EQ(plan.targets, expected);
  EXPECT_NE(plan.targets, world.start_positions);
}

struct PlansOfEveryIntegrator : WithEveryIntegrator {};
INSTANTIATE_TEST_SUITE_P(Catalogue, PlansOfEveryIntegrator, ::testing::ValuesIn(integrator_names()),
                         name_of_integrator);

/// Stages whose unknowns are where their plans lead them end where supports are at the end of the step.
TEST_P(PlansOfEveryIntegrator, LeadSupportsToTheEndOfTheStep) {
  const World world(led_bar(true));
  const auto scheme = make_integrator(integrator, "test");
  constexpr double dt = 0.02;
  State start;
  start.time = 0.5;
  start.positions = world.rest_positions;
  start.velocities = VectorX::Zero(start.positions.size());
  Motion now{start.positions, start.velocities, start.velocities};
  place_supports(world.dimension, world.supports, world.rest_positions, start.time, now);
  start.positions = now.positions;
  start.velocities = now.velocities;
  start.accelerations = now.accelerations;
  bool is_mean = false;
  StageSequence stages(*scheme, {.now = now}, dt);
  for (int i = 0; i < scheme->num_stages(); ++i) {
    const Stage begun = stages.begin();
    const StagePlan plan = plan_in_motion(world, start, dt, begun, stages.last_positions());
    EXPECT_EQ(plan.conditions.time, start.time + begun.time_fraction * dt);
    EXPECT_EQ(plan.conditions.delay, 0);
    is_mean = plan.stage.is_mean;
    for (Eigen::Index k = 0; k < plan.targets.size(); ++k) {
      if (world.is_fixed[static_cast<std::size_t>(k)] != 0) continue;
      EXPECT_EQ(plan.targets[k], stages.last_positions()[k]);
      EXPECT_EQ(plan.stage.base_positions[k], begun.base_positions[k]);
      EXPECT_EQ(plan.stage.base_velocities[k], begun.base_velocities[k]);
    }
    stages.end(plan.stage, plan.stage.motion(plan.targets));
  }
  const Motion end = stages.finish();
  Motion expected = end;
  place_supports(world.dimension, world.supports, world.rest_positions, start.time + dt, expected);
  EXPECT_NE(expected.positions, now.positions);
  EXPECT_LT((end.positions - expected.positions).cwiseAbs().maxCoeff(), 1e-13);
  const double most = (end.velocities - expected.velocities).cwiseAbs().maxCoeff();
  EXPECT_TRUE(is_mean || most < 1e-11) << most;
}

}  // namespace
}  // namespace resilin::testing
