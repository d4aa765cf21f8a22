// Progress of a step while it goes on.

#include "resilin/results/step_progress.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "small_scenes.hpp"

namespace resilin::testing {
namespace {

using ::testing::ContainsRegex;

/// The texts of the iterations of `steps` steps.
std::vector<std::string> texts_of(const Description& scene, int steps) {
  Simulation simulation(scene);
  std::vector<std::string> texts;
  for (int i = 0; i < steps; ++i) {
    int iterations = 0;
    simulation.step([&](const NewtonReport& so_far) {
      texts.push_back(describe_progress(simulation, so_far, ++iterations));
      return true;
    });
  }
  return texts;
}

TEST(StepProgress, TellsStepLoadIterationAndResidualAgainstTheTolerance) {
  Description scene = small_bar(3, false);
  scene.load_steps = 4;
  const std::vector<std::string> texts = texts_of(scene, 2);
  const std::string residual = ", residual [0-9.e+-]+ \\(tolerance 1e-08\\)$";
  EXPECT_THAT(texts.front(),
              ContainsRegex("^step 1, from load factor 0 by 0.25 at most, Newton iteration 1" + residual));
  EXPECT_THAT(texts[1], ContainsRegex("Newton iteration 2" + residual));
  EXPECT_THAT(texts.back(), ContainsRegex("^step 2, from load factor 0.25 by 0.25 at most, Newton"));
}

TEST(StepProgress, TellsTheTimeInMotion) {
  const std::vector<std::string> texts = texts_of(small_bar(3, true), 3);
  EXPECT_THAT(texts.front(), ContainsRegex("^step 1, from t = 0 s, Newton iteration 1, residual "));
  EXPECT_THAT(texts.back(), ContainsRegex("^step 3, from t = 0.04 s, Newton iteration [0-9]+, residual "));
}

TEST(StepProgress, SaysWhenModesAreLookedFor) {
  Description scene = small_bar(3, false);
  scene.modes.emplace().count = 2;
  for (const std::string& text : texts_of(scene, 1)) EXPECT_EQ(text, "step 1, solving for vibration modes");
}

}  // namespace
}  // namespace resilin::testing
