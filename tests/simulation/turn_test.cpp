// Supports that turn by any angle go their whole way, at rest and in motion.

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "every_integrator.hpp"
#include "small_scenes.hpp"

namespace resilin::testing {
namespace {

/// A bar of 24 cubes along x, held at x = 0, whose other end turns about its axis; soft enough to be wound
/// up.
Description wound_bar(double degrees, bool is_dynamic) {
  Description scene;
  scene.is_dynamic = is_dynamic;
  scene.time_step = 0.02;
  scene.end_time = 0.4;
  BodyDescription body;
  body.mesh = make_hexahedron_box({2.4, 0.1, 0.1}, {24, 1, 1}, {0, -0.05, -0.05});
  body.element = "Q1";
  body.material.constants = {{"youngs_modulus", 1e6}, {"poissons_ratio", 0.3}};
  scene.bodies.push_back(body);
  FixDescription wall;
  wall.name = "wall";
  wall.where.kind = Where::Kind::plane;
  scene.fixes.push_back(wall);
  FixDescription end = wall;
  end.name = "end";
  end.where.at = 2.4;
  end.rotate = Rotation{.axis = Vector3::UnitX(), .degrees = degrees};
  scene.fixes.push_back(end);
  return scene;
}

/// By how much the bar is wound up, section by section, each by less than half a turn [degrees].
double winding(const Simulation& simulation) {
  const World& world = simulation.world();
  double sum = 0, last = 0;
  for (int section = 0; section <= 24; ++section) {
    // The direction of an edge of the section, along y at rest.
    Vector3 low = Vector3::Zero(), high = low;
    for (Index node = 0; node < world.num_nodes(); ++node) {
      const Vector3 X = world.rest_positions.segment<3>(3 * node);
      if (std::abs(X.x() - 0.1 * section) > 1e-9 || X.z() > 0) continue;
      (X.y() < 0 ? low : high) = simulation.state().positions.segment<3>(3 * node);
    }
    const double angle = std::atan2((high - low).z(), (high - low).y());
    if (section > 0) sum += std::remainder(angle - last, 2 * std::numbers::pi);
    last = angle;
  }
  return sum * 180 / std::numbers::pi;
}

TEST(TurnsInStatics, GoTheirWholeWay) {
  for (const double degrees : {45.0, 180.0, 200.0, 270.0, -360.0, 540.0}) {
    for (const int load_steps : {1, 3}) {
      Description scene = wound_bar(degrees, false);
      scene.load_steps = load_steps;
      Simulation simulation(scene);
      double load = 0;
      while (!simulation.is_finished()) {
        const StepReport report = simulation.step();
        ASSERT_EQ(report.status, StepReport::Status::converged) << degrees << ": " << report.reason;
        EXPECT_LE(std::abs(degrees) * (simulation.state().load - load), 60 * (1 + 1e-9));
        load = simulation.state().load;
      }
      EXPECT_NEAR(winding(simulation), degrees, 1e-6 * std::abs(degrees));
    }
  }
}

TEST(TurnsInStatics, GoTheirWholeWayAlongAFunctionAndByArcLength) {
  Description scene = wound_bar(540, false);
  scene.end_time = 1;
  scene.fixes[1].time_function.form =
      TimeFunction::Table{.times = {0, 0.5, 0.5001, 1}, .values = {0, 0, 1, 1}};
  EXPECT_NEAR(winding(converged_end_of(scene)), 540, 1e-3);
  scene.fixes[1].time_function = {};
  scene.load_control = LoadControlKind::arc_length;
  EXPECT_NEAR(winding(converged_end_of(scene)), 540, 1e-3);
}

struct TurnsOfEveryIntegrator : WithEveryIntegrator {};
INSTANTIATE_TEST_SUITE_P(Catalogue, TurnsOfEveryIntegrator, ::testing::ValuesIn(integrator_names()),
                         name_of_integrator);

/// In a steady turn of up to 54 degrees in each step, and at once, which is led there in steps of 60 degrees.
TEST_P(TurnsOfEveryIntegrator, GoTheirWholeWay) {
  for (const double degrees : {270.0, -540.0}) {
    for (const bool at_once : {false, true}) {
      Description scene = wound_bar(degrees, true);
      scene.integrator = integrator;
      scene.bodies[0].damping.mass = 5;
      if (!at_once) scene.fixes[1].time_function.form = TimeFunction::Ramp{.from = 0.1, .until = 0.3};
      Simulation simulation(scene);
      while (!simulation.is_finished()) simulation.step();
      EXPECT_EQ(simulation.state().step, 20);
      EXPECT_NEAR(winding(simulation), degrees, 1e-6 * std::abs(degrees)) << degrees << " " << at_once;
    }
  }
}

TEST(TurnsOfAdaptiveSteps, GoTheirWholeWay) {
  for (const bool at_once : {false, true}) {
    Description scene = wound_bar(450, true);
    scene.integrator = "tr_bdf2";
    scene.adaptive.emplace().tolerance = 1e-2;
    scene.bodies[0].damping.mass = 5;
    if (!at_once) scene.fixes[1].time_function.form = TimeFunction::Ramp{.from = 0.1, .until = 0.3};
    Simulation simulation(scene);
    while (!simulation.is_finished()) simulation.step();
    EXPECT_EQ(simulation.state().time, scene.end_time);
    EXPECT_NEAR(winding(simulation), 450, 1e-3);
  }
}

}  // namespace
}  // namespace resilin::testing
