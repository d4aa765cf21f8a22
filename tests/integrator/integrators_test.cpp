// Properties that every integrator in the catalogue must have, seen on a harmonic oscillator, whose stages
// have a closed solution: min_x 1/(2 s) (x - x~)^2 + w^2/2 x^2 gives x = x~ / (1 + s w^2).

#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "resilin/core/error.hpp"
#include "resilin/integrator/integrator.hpp"

namespace resilin {
namespace {

Motion advance(const Integrator& integrator, Motion motion, double frequency, double time_step,
               int num_steps) {
  for (int step = 0; step < num_steps; ++step) {
    std::vector<VectorX> solutions;
    for (int i = 0; i < integrator.num_stages(); ++i) {
      const Stage stage = integrator.begin_stage(i, motion, solutions, time_step);
      solutions.emplace_back(stage.target / (1 + stage.scale * frequency * frequency));
    }
    motion = integrator.finish(motion, solutions, time_step);
  }
  return motion;
}

double error_at_one_second(const Integrator& integrator, int num_steps) {
  const Motion start{.positions = VectorX::Constant(1, 1.0), .velocities = VectorX::Constant(1, 0.5)};
  const double w = 3;
  const Motion end = advance(integrator, start, w, 1.0 / num_steps, num_steps);
  return std::abs(end.positions[0] - (std::cos(w) + 0.5 / w * std::sin(w)));
}

TEST(EveryIntegrator, HasItsOrder) {
  const std::map<std::string, double> orders = {{"backward_euler", 1}};
  for (const std::string& name : integrator_names()) {
    ASSERT_TRUE(orders.contains(name)) << name << " has no order here";
    const auto integrator = make_integrator(name, "test");
    const double order =
        std::log2(error_at_one_second(*integrator, 512) / error_at_one_second(*integrator, 1024));
    EXPECT_NEAR(order, orders.at(name), 0.1) << name;
  }
}

TEST(EveryIntegrator, KeepsAFreeNodeAtItsSpeed) {
  for (const std::string& name : integrator_names()) {
    const Motion start{.positions = VectorX::Constant(1, 2.0), .velocities = VectorX::Constant(1, 0.25)};
    const Motion end = advance(*make_integrator(name, "test"), start, 0, 0.125, 8);
    EXPECT_NEAR(end.positions[0], 2.25, 1e-14) << name;
    EXPECT_NEAR(end.velocities[0], 0.25, 1e-14) << name;
  }
}

TEST(BackwardEuler, LosesEnergyHoweverLongTheStep) {
  for (const double dt : {1e-3, 1.0, 1e3}) {
    const Motion start{.positions = VectorX::Constant(1, 1.0), .velocities = VectorX::Constant(1, 0.5)};
    const Motion end = advance(*make_integrator("backward_euler", "test"), start, 3, dt, 1);
    const auto energy = [](const Motion& m) {
      return 4.5 * m.positions.squaredNorm() + 0.5 * m.velocities.squaredNorm();
    };
    EXPECT_LT(energy(end), energy(start));
  }
}

TEST(Integrator, UnknownNameListsTheKnownOnes) {
  try {
    make_integrator("rk4", "scene.toml: simulation.integrator");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(),
                 "scene.toml: simulation.integrator: expected one of backward_euler, got \"rk4\"");
  }
}

}  // namespace
}  // namespace resilin
