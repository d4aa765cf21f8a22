// Any time step and any end: refused in one line, or stepped as they say.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "small_scenes.hpp"

namespace resilin::testing {
namespace {

using ::testing::HasSubstr;

Description scene_of(double time_step, double end_time) {
  Description scene = small_bar(2, true);
  scene.bodies[0].mesh = make_rectangle({1, 0.5}, {2, 1});
  scene.newton.max_iterations = 20;
  scene.time_step = time_step;
  scene.end_time = end_time;
  return scene;
}

TEST(TimeKeys, ThatMakeNoSenseAreRefused) {
  EXPECT_THAT(refusal_of(scene_of(1e9, 1)),
              HasSubstr("simulation.time_step: expected at most simulation.end_time, 1 s, got 1e+09"));
  EXPECT_THAT(refusal_of(scene_of(0.01, 1e16)),
              HasSubstr("at most 1e+09 steps until the end, got 1e+18 of 0.01 s"));
  EXPECT_THAT(refusal_of(scene_of(1e-300, 1)),
              HasSubstr("simulation.time_step: expected from 1e-30 to 1e+30 s"));
  EXPECT_THAT(refusal_of(scene_of(1e-300, 1e-299)), HasSubstr("simulation.time_step: expected from 1e-30"));
  EXPECT_THAT(refusal_of(scene_of(1, 1e300)), HasSubstr("simulation.end_time: expected from 1e-30"));
  EXPECT_THAT(refusal_of(scene_of(0.3, 0.2)), HasSubstr("shorten the step or set a later end"));
  EXPECT_EQ(refusal_of(scene_of(0.2, 0.2)), "");
}

TEST(TimeKeys, OfAdaptiveStepsAreNotLostInTheTime) {
  Description scene = scene_of(0.01, 1);
  scene.integrator = "newmark";
  for (const double lost : {1e-300, 1e-20, 1e-17}) {
    scene.adaptive = AdaptiveSteps{.tolerance = 1e-4, .min_step = lost, .max_step = {}};
    EXPECT_THAT(refusal_of(scene), HasSubstr("adaptive.min_step: expected at least 1e-15 s")) << lost;
    scene.adaptive = AdaptiveSteps{.tolerance = 1e-4, .min_step = {}, .max_step = lost};
    EXPECT_THAT(refusal_of(scene), HasSubstr("adaptive.max_step: expected at least 1e-15 s")) << lost;
  }
  scene.adaptive = AdaptiveSteps{
      .tolerance = 1e-300, .min_step = {}, .max_step = {}};  // no step is good enough: the shortest are taken
  Simulation simulation(scene);
  for (int i = 1; i <= 3; ++i) {
    simulation.step();
    EXPECT_NEAR(simulation.state().time, i * 1e-8, 1e-15);
  }
}

/// Over all magnitudes that a number of a scene can have.
TEST(TimeKeys, OfAnyMagnitudeAreRefusedOrStepped) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> exponent(-320, 308), steps(-3, 12);
  int stepped = 0;
  for (int i = 0; i < 400; ++i) {
    const double time_step = std::pow(10, i % 2 == 0 ? exponent(random) : exponent(random) / 12);
    const double end_time =
        i % 4 == 0 ? std::pow(10, exponent(random)) : time_step * std::pow(10, steps(random));
    SCOPED_TRACE(::testing::Message() << time_step << " " << end_time);
    Description scene = scene_of(time_step, end_time);
    const std::string message = refusal_of(scene);
    EXPECT_EQ(message.find('\n'), message.npos);
    if (!message.empty()) {
      EXPECT_THAT(message, HasSubstr("simulation."));
      continue;
    }
    ++stepped;
    ASSERT_GE(end_time / time_step, 1);
    ASSERT_LE(end_time / time_step, 1e9);
    Simulation simulation(scene);
    EXPECT_LE(std::abs(simulation.expected_steps() - end_time / time_step), 1 + 1e-9 * end_time / time_step);
    for (int step = 1; step <= 2 && !simulation.is_finished(); ++step) {
      const StepReport report = simulation.step();
      EXPECT_EQ(simulation.state().step, step);
      EXPECT_EQ(simulation.state().time, step * time_step);
      EXPECT_TRUE(simulation.state().positions.allFinite()) << report.reason;
    }
  }
  EXPECT_GT(stepped, 60);
}

}  // namespace
}  // namespace resilin::testing
