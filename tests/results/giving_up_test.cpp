// Runs that find no solution any more end soon, and say what failed where.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "resilin/integrator/integrator.hpp"
#include "resilin/results/run.hpp"
#include "small_scenes.hpp"

namespace resilin::testing {
namespace {

using ::testing::AllOf;
using ::testing::ContainsRegex;
using ::testing::HasSubstr;

/// A wall of 20 x 20 x 1 mm, held all round, under a pressure from below that bursts it.
Description bursting_wall(bool is_dynamic) {
  Description scene;
  scene.is_dynamic = is_dynamic;
  scene.time_step = 2e-3;
  scene.end_time = 0.02;
  BodyDescription body;
  body.name = "wall";
  body.element = "P1";
  body.mesh = make_box({0.02, 0.02, 0.001}, {4, 4, 1});
  body.material.law = "neo_hookean";
  body.material.constants = {{"youngs_modulus", 1e6}, {"poissons_ratio", 0.49}};
  scene.bodies.push_back(std::move(body));
  for (const char* side : {"x_min", "x_max", "y_min", "y_max"}) {
    FixDescription fix;
    fix.name = side;
    fix.where.kind = Where::Kind::group;
    fix.where.group = side;
    scene.fixes.push_back(fix);
  }
  LoadDescription load;
  load.kind = "pressure";
  load.where.kind = Where::Kind::group;
  load.where.group = "z_min";
  load.pressure = 1e7;
  scene.loads.push_back(load);
  return scene;
}

const auto names_the_place = ContainsRegex("\"wall\" at \\(.*cell [0-9]+ at \\(");

TEST(GivingUp, EndsAMotionAfterAFewStepsInARowWithoutASolution) {
  for (const std::string& integrator : integrator_names()) {
    for (const bool is_adaptive : {false, true}) {
      SCOPED_TRACE(integrator + (is_adaptive ? ", adaptive" : ""));
      Description scene = bursting_wall(true);
      scene.integrator = integrator;
      scene.newton.max_failures = 2;
      if (is_adaptive) scene.adaptive.emplace().min_step = scene.time_step;
      Simulation simulation(scene);
      const RunOutcome outcome = run_to_end(simulation, {});
      EXPECT_EQ(outcome.status, RunStatus::not_converged);
      EXPECT_FALSE(simulation.is_finished());
      EXPECT_EQ(simulation.failed_steps().in_a_row, 2);
      EXPECT_THAT(outcome.reason, AllOf(HasSubstr("for 2 steps in a row did not converge"), names_the_place,
                                        HasSubstr(is_adaptive ? "min_step" : "simulation.time_step")));
    }
  }
}

TEST(GivingUp, GoesOnWhenItIsToldTo) {
  Description scene = bursting_wall(true);
  scene.end_time = 3 * scene.time_step;
  scene.newton.max_failures = 0;
  Simulation simulation(scene);
  const RunOutcome outcome = run_to_end(simulation, {});
  EXPECT_TRUE(simulation.is_finished());
  EXPECT_THAT(outcome.reason, HasSubstr("steps did not converge"));
}

/// A truncated step is no failure of the body.
TEST(GivingUp, DoesNotEndRunsThatAreCutShortOnPurpose) {
  for (const int iterations : {1, 2, 5}) {
    Description scene = bursting_wall(true);
    scene.newton.max_iterations = iterations;
    Simulation simulation(scene);
    const RunOutcome outcome = run_to_end(simulation, {});
    EXPECT_TRUE(simulation.is_finished()) << outcome.reason;
    EXPECT_EQ(simulation.failed_steps().in_a_row, 0);
  }
}

TEST(GivingUp, SaysWhereAWallBurstsInStatics) {
  for (const char* element : {"P1", "P2", "P2P0"}) {
    SCOPED_TRACE(element);
    Description scene = bursting_wall(false);
    scene.bodies[0].element = element;
    Simulation simulation(scene);
    const RunOutcome outcome = run_to_end(simulation, {});
    EXPECT_EQ(outcome.status, RunStatus::not_converged);
    EXPECT_THAT(outcome.reason,
                AllOf(HasSubstr("no equilibrium was found beyond load factor"), names_the_place));
  }
}

}  // namespace
}  // namespace resilin::testing
