// Conditions on the numbers of every scheme.

#include <gtest/gtest.h>

#include "resilin/integrator/integrator.hpp"

namespace resilin {
namespace {

struct SchemeCoefficients : ::testing::TestWithParam<std::string> {
  std::unique_ptr<Integrator> integrator = make_integrator(GetParam(), "test");
};

/// A node that stands still starts every stage where it is, and one of constant speed reaches the place of
/// the stage's time: the values add up to 1, and with the slopes and c to the time.
TEST_P(SchemeCoefficients, AreExactForUniformMotion) {
  for (const double ratio : {0.0, 0.5, 1.0, 3.0}) {
    const StepCoefficients scheme = integrator->coefficients(ratio);
    for (const StageCoefficients& stage : scheme.stages) {
      const double previous_time = ratio == 0 ? 0 : -1 / ratio;
      double values = stage.start.value + stage.previous;
      double time = stage.start.slope + stage.previous * previous_time + stage.duration;
      for (std::size_t k = 0; k < stage.stages.size(); ++k) {
        values += stage.stages[k].value;
        time += stage.stages[k].value * scheme.stages[k].time_fraction + stage.stages[k].slope;
      }
      EXPECT_NEAR(values, 1, 1e-15);
      EXPECT_NEAR(time, stage.time_fraction, 1e-15);
      EXPECT_GT(stage.duration, 0);
    }
    EXPECT_NEAR(scheme.end_start + scheme.end_stage, 1, 1e-15);
    EXPECT_NEAR(scheme.end_stage * scheme.stages.back().time_fraction, 1, 1e-15);
    if (ratio == 0) {
      for (const StageCoefficients& stage : scheme.stages)
        EXPECT_EQ(stage.previous, 0) << "nothing was before";
    }
  }
}

/// Damping is formed at a shape that a body of constant speed has at the stage's time, for schemes of second
/// order; a scheme of first order keeps the shape of the start.
TEST_P(SchemeCoefficients, ExpectTheShapeOfTheStage) {
  const double dt = 0.25;
  const VectorX x = VectorX::Constant(1, 3), v = VectorX::Constant(1, 2), a = VectorX::Zero(1);
  const History start{
      .now = {x, v, a}, .previous_positions = x - dt * v, .previous_velocities = v, .previous_time_step = dt};
  std::vector<Motion> solutions;
  for (int i = 0; i < integrator->num_stages(); ++i) {
    const Stage stage = integrator->begin_stage(i, start, solutions, dt);
    const double passed = integrator->order() == 1 ? 0 : stage.time_fraction * dt;
    EXPECT_NEAR(stage.shape[0], 3 + 2 * passed, 1e-14);
    solutions.push_back(stage.motion(stage.target()));
    EXPECT_NEAR(solutions.back().positions[0], 3 + 2 * stage.time_fraction * dt, 1e-14);
    EXPECT_NEAR(solutions.back().velocities[0], 2, 1e-14);
  }
}

INSTANTIATE_TEST_SUITE_P(All, SchemeCoefficients, ::testing::ValuesIn(integrator_names()),
                         [](const ::testing::TestParamInfo<std::string>& scheme) { return scheme.param; });

}  // namespace
}  // namespace resilin
