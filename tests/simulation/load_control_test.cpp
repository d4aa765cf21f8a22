// Load steps, paths through limit points, and the stability of what is found.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "reference_case.hpp"
#include "resilin/element/axisymmetric.hpp"
#include "resilin/mesh/round_generators.hpp"
#include "small_scenes.hpp"

namespace resilin::testing {
namespace {

using ::testing::HasSubstr;

TEST(LoadSteps, MeetEveryLoadThatTheSceneAsksFor) {
  Description scene = small_bar(3, false);
  scene.load_steps = 4;
  scene.newton.max_iterations = 4;  // some steps fail and are halved
  Simulation simulation(scene);
  std::vector<double> loads;
  int failed_attempts = 0;
  while (!simulation.is_finished()) {
    const StepReport report = simulation.step();
    ASSERT_EQ(report.status, StepReport::Status::converged);
    failed_attempts += report.failed_attempts;
    loads.push_back(simulation.state().load);
  }
  EXPECT_GT(failed_attempts, 0);
  EXPECT_GT(loads.size(), 4U);
  for (const double asked : {0.25, 0.5, 0.75, 1.0}) EXPECT_THAT(loads, ::testing::Contains(asked));
}

/// A bar whose far end turns about its axis by so many degrees.
Description turned_bar(double degrees) {
  Description scene = small_bar(3, false);
  scene.gravity.setZero();
  FixDescription turned = scene.fixes[0];
  turned.where.at = 1;
  turned.rotate = Rotation{.axis = Vector3::UnitX(), .center = {0, 0.125, 0.125}, .degrees = degrees};
  scene.fixes.push_back(turned);
  return scene;
}

/// At half the load a support that turns by half a turn stands at a quarter, not half-way along the chord.
TEST(LoadSteps, TurnSupportsAlongTheirArc) {
  Description scene = turned_bar(180);
  scene.load_steps = 4;
  Simulation simulation(scene);
  while (simulation.state().load < 0.5) ASSERT_EQ(simulation.step().status, StepReport::Status::converged);
  ASSERT_EQ(simulation.state().load, 0.5);
  // The corner (1, 0.25, 0.25) of the turned face is the probe.
  EXPECT_LT((simulation.frame().probes[0].displacement - Vector3(0, -0.25, 0)).norm(), 1e-12);
}

/// A column of 1 m, 0.1 m thick, clamped at its foot, pressed at its head by `factor` times Euler's load
/// pi^2 E I / (4 L^2). Without Poisson's effect the straight column is an equilibrium of the mesh.
Description column(int dimension, double factor) {
  constexpr double E = 1e6, thickness = 0.1;
  Description scene;
  scene.dimension = dimension;
  BodyDescription body;
  body.element = "P1";
  body.mesh = dimension == 3 ? make_box({thickness, thickness, 1}, {4, 4, 40})
                             : make_rectangle({thickness, 1}, {4, 40});
  body.material.law = "neo_hookean";
  body.material.constants = {{"youngs_modulus", E}, {"poissons_ratio", 0}};
  scene.bodies.push_back(body);
  FixDescription foot;
  foot.where.kind = Where::Kind::plane;
  foot.where.axis = dimension - 1;
  scene.fixes.push_back(foot);
  LoadDescription press;
  press.kind = "traction";
  press.where = foot.where;
  press.where.at = 1;
  const double second_moment_per_area = thickness * thickness / 12;
  press.value[dimension - 1] = -factor * std::numbers::pi * std::numbers::pi * E * second_moment_per_area / 4;
  scene.loads.push_back(press);
  return scene;
}

TEST(UnstableModes, AreCountedBeyondEulersLoad) {
  for (const int dimension : {2, 3}) {
    // Linear cells are stiffer in bending than Euler's column, by less than half here.
    for (const double factor : {0.8, 3.0}) {
      SCOPED_TRACE(std::to_string(dimension) + "D, Euler's load times " + std::to_string(factor));
      Description scene = column(dimension, factor);
      scene.load_control =
          LoadControlKind::arc_length;  // load steps minimise: they may find the way to the bent column
      Simulation simulation(scene);
      StepReport report;
      std::vector<std::string> warnings;
      while (!simulation.is_finished()) {
        report = simulation.step();
        ASSERT_EQ(report.status, StepReport::Status::converged);
        warnings.insert(warnings.end(), report.warnings.begin(), report.warnings.end());
      }
      const VectorX& x = simulation.state().positions;
      const VectorX& X = simulation.world().rest_positions;
      double sideways = 0;
      for (Eigen::Index i = 0; i < x.size(); i += dimension)
        sideways = std::max(sideways, std::abs(x[i] - X[i]));
      ASSERT_LT(sideways, 1e-6) << "the column did not stay straight";
      // To the one side or the other: one mode in the plane, two in space.
      const Index expected = factor < 1 ? 0 : dimension - 1;
      ASSERT_TRUE(report.unstable_modes.has_value());
      EXPECT_EQ(*report.unstable_modes, expected);
      EXPECT_EQ(*simulation.frame().unstable_modes, expected);
      EXPECT_EQ(warnings.size(), expected > 0 ? 1U : 0U);
      for (const std::string& warning : warnings) EXPECT_THAT(warning, HasSubstr("unstable"));
    }
  }
}

TEST(UnstableModes, AreNotCountedWhenTheSceneSaysSo) {
  Description scene = column(2, 3);
  scene.unstable_modes = UnstableModes::skip;
  Simulation simulation(scene);
  simulation.step();
  EXPECT_FALSE(simulation.frame().unstable_modes.has_value());
}

constexpr double arch_load = 40;  ///< [N]

/// A shallow arch of 1 m span and 0.1 m rise, 0.03 m thick, clamped at both ends and pressed at its middle.
Description shallow_arch() {
  Description scene;
  scene.dimension = 2;
  BodyDescription body;
  body.element = "P1";
  body.mesh = make_rectangle({1, 0.03}, {32, 2});
  for (Vector3& X : body.mesh.vertices) X.y() += 0.1 * std::sin(std::numbers::pi * X.x());
  body.material.law = "neo_hookean";
  body.material.constants = {{"youngs_modulus", 1e5}, {"poissons_ratio", 0.3}};
  scene.bodies.push_back(body);
  for (const double end : {0.0, 1.0}) {
    FixDescription clamp;
    clamp.where.kind = Where::Kind::plane;
    clamp.where.at = end;
    scene.fixes.push_back(clamp);
  }
  LoadDescription press;
  press.kind = "nodal_force";
  press.where.kind = Where::Kind::sphere;
  press.where.center = {0.5, 0.13, 0};
  press.where.radius = 1e-3;
  press.value = {0, -arch_load, 0};
  scene.loads.push_back(press);
  scene.probes.push_back({.name = "crown", .body = "", .at = {0.5, 0.13, 0}});
  scene.load_control = LoadControlKind::arc_length;
  scene.load_steps = 10;
  return scene;
}

/// The same arch pressed by a prescribed displacement of its crown [m]: the force that this takes, over the
/// arch load. No path is followed here.
double load_at_displacement(double displacement) {
  Description scene = shallow_arch();
  scene.load_control = LoadControlKind::load;
  FixDescription crown;
  crown.name = "crown";
  crown.where = scene.loads[0].where;
  crown.components = {false, true, false};
  crown.displacement = {0, displacement, 0};
  scene.fixes.push_back(crown);
  scene.loads.clear();
  scene.load_steps = 4;
  const Simulation simulation = run_all(scene);
  EXPECT_TRUE(simulation.is_finished());
  return -simulation.frame().reactions.back().second.y() / arch_load;
}

TEST(ArcLength, FollowsAShallowArchThroughBothLimitPoints) {
  Simulation simulation(shallow_arch());
  std::vector<double> loads = {0}, heights = {0};
  bool was_unstable = false;
  while (!simulation.is_finished()) {
    const StepReport report = simulation.step();
    ASSERT_EQ(report.status, StepReport::Status::converged) << report.reason;
    EXPECT_LE(report.newton.residual, 1e-8 * report.newton.force_scale);
    loads.push_back(simulation.frame().load);
    heights.push_back(simulation.frame().probes[0].displacement.y());
    was_unstable = was_unstable || simulation.frame().unstable_modes.value() > 0;
  }
  EXPECT_EQ(loads.back(), 1);
  EXPECT_TRUE(was_unstable);
  EXPECT_EQ(simulation.frame().unstable_modes, 0);
  int num_turns = 0;
  for (std::size_t i = 2; i < loads.size(); ++i)
    num_turns += (loads[i] - loads[i - 1]) * (loads[i - 1] - loads[i - 2]) < 0 ? 1 : 0;
  EXPECT_EQ(num_turns, 2);
  for (std::size_t i = 1; i < loads.size(); i += 3)
    EXPECT_NEAR(loads[i], load_at_displacement(heights[i]), 1e-6) << "at a displacement of " << heights[i];
}

/// A balloon of rubber, in its half section: its pressure rises to a limit point and falls. Exact for a
/// neo-Hookean shell of constant volume: p = mu (2/b + 1/(2 b^4) - 2/a - 1/(2 a^4)), with the stretches a
/// inside and b outside.
TEST(ArcLength, FollowsABalloonBeyondItsLargestPressure) {
  constexpr double inner = 0.95, outer = 1.05, shear_modulus = 1e5, largest = 2e4 /* Pa */;
  Description scene;
  scene.dimension = 2;
  BodyDescription body;
  body.element = axisymmetric_name("P2P0");
  body.mesh = make_round({.kind = RoundKind::ring,
                          .radius = outer,
                          .inner_radius = inner,
                          .degrees = 90,
                          .radial_cells = 2,
                          .around_cells = 16,
                          .is_quadratic = true});
  body.material.law = "neo_hookean_isochoric";
  body.material.constants = {{"shear_modulus", shear_modulus}, {"bulk_modulus", 1e9}};
  scene.bodies.push_back(body);
  FixDescription equator = fix("equator", group("start"));
  equator.components = {false, true, false};
  scene.fixes.push_back(equator);
  LoadDescription gas;
  gas.kind = "pressure";
  gas.where = group("inner");
  gas.pressure = largest;
  scene.loads.push_back(gas);
  scene.probes.push_back(probe("pole", {0, inner, 0}));
  scene.load_control = LoadControlKind::arc_length;
  scene.load_steps = 10;
  Simulation simulation(scene);
  double peak = 0, load = 0;
  for (int step = 0; step < 60 && load >= 0.98 * peak; ++step) {
    const StepReport report = simulation.step();
    ASSERT_EQ(report.status, StepReport::Status::converged) << report.reason;
    const Frame frame = simulation.frame();
    load = frame.load;
    peak = std::max(peak, load);
    const double a = 1 + frame.probes[0].displacement.y() / inner;
    const double b = std::cbrt(1 + (a * a * a - 1) * std::pow(inner / outer, 3));
    const double pressure = shear_modulus * (2 / b + 0.5 / std::pow(b, 4) - 2 / a - 0.5 / std::pow(a, 4));
    EXPECT_NEAR(load * largest, pressure, 2e-3 * pressure) << "at a stretch of " << a;
  }
  EXPECT_LT(load, 0.98 * peak);
}

TEST(Jumps, OfAnArchThatSnapsThroughIsToldOrStoppedBefore) {
  Simulation path(shallow_arch());
  double limit = 0;  // the first maximum of the load
  for (double load = 0; load >= limit; load = path.state().load) {
    limit = load;
    ASSERT_EQ(path.step().status, StepReport::Status::converged);
  }
  Description scene = shallow_arch();
  scene.load_control = LoadControlKind::load;
  Simulation simulation(scene);
  int jumps = 0;
  while (!simulation.is_finished()) {
    const double before = simulation.frame().elastic_energy;
    const StepReport report = simulation.step();
    ASSERT_EQ(report.status, StepReport::Status::converged) << report.reason;
    EXPECT_EQ(simulation.frame().jump_energy, report.jump_energy);
    if (report.jump_energy == 0) continue;
    ++jumps;
    EXPECT_GT(report.jump_energy, 0.1 * before);
    ASSERT_EQ(report.warnings.size(), 1U);
    EXPECT_THAT(report.warnings[0], HasSubstr("jump to another equilibrium"));
  }
  EXPECT_EQ(jumps, 1);
  EXPECT_EQ(simulation.state().jumps, 1);
  EXPECT_NEAR(simulation.state().largest_jump_load, limit, 0.02);
  scene.on_jump = OnJump::stop;
  Simulation stopped(scene);
  StepReport last;
  do last = stopped.step();
  while (last.status == StepReport::Status::converged && !stopped.is_finished());
  EXPECT_EQ(last.status, StepReport::Status::not_converged);
  EXPECT_THAT(last.reason, HasSubstr("simulation.on_jump"));
  EXPECT_LE(stopped.state().load, limit);
}

/// Bars that are bent, drawn and turned far in one step.
TEST(Jumps, AreNotToldOfWhereThereIsNone) {
  for (const int dimension : {2, 3})
    for (const double load : {0.1, 1.0, 10.0, 100.0}) {
      Description bent = small_bar(dimension, false);
      bent.gravity *= load;
      Description drawn = small_bar(dimension, false);
      FixDescription grip = drawn.fixes[0];
      grip.where.at = 1;
      grip.displacement = {0.02 * load, 0.001 * load, 0};
      drawn.fixes.push_back(grip);
      for (const Description& scene : {bent, drawn}) {
        const Simulation simulation = run_all(scene);
        EXPECT_EQ(simulation.state().jumps, 0) << dimension << "D, " << load;
      }
    }
}

/// A bar that is turned until it cannot bear more: what it loses then is no work of its ends.
TEST(Jumps, OfABarThatIsTurnedTooFarAreTold) {
  Description scene = turned_bar(900);
  Simulation simulation(scene);
  double most = 0;
  while (!simulation.is_finished() && simulation.step().status == StepReport::Status::converged) {
    const double energy = simulation.frame().elastic_energy;
    const bool is_lost = energy < 0.7 * most;
    EXPECT_TRUE(!is_lost || simulation.frame().jump_energy > 0.1 * most) << simulation.state().load;
    most = std::max(most, energy);
    if (simulation.frame().jump_energy > 0) most = energy;
  }
}

/// One end of a bar turns by 360 degrees about the middle of the bar, or about the other end. The bar is then
/// without stress only if it has jumped: to its mirror image, or twice with a small part of its energy.
TEST(Jumps, ThatLoseLittleAreToldInLongSteps) {
  Description plane = small_bar(2, false), space = small_bar(3, false);
  plane.bodies[0].mesh = make_quadrilateral_rectangle({1, 0.25}, {8, 1});
  plane.bodies[0].element = "Q1";
  plane.bodies[0].material.law = "stable_neo_hookean";
  space.bodies[0].mesh = make_box({1, 0.5, 0.25}, {4, 1, 1});
  space.bodies[0].element = "P2";
  space.bodies[0].material.law = "neo_hookean";
  plane.fixes.push_back(plane.fixes[0]);
  plane.fixes[1].rotate = Rotation{.center = {0.5, 0.125, 0}, .degrees = 360};
  space.fixes.push_back(space.fixes[0]);
  space.fixes[1].rotate = Rotation{.center = {0, 0.25, 0.125}, .degrees = 360};
  for (Description scene : {plane, space})
    for (const int load_steps : {1, 8, 24}) {
      scene.gravity.setZero();
      scene.bodies[0].material.constants = {{"youngs_modulus", 1e5}, {"poissons_ratio", 0.3}};
      scene.fixes[1].where.at = 1;
      scene.load_steps = load_steps;
      const Simulation simulation = run_all(scene);
      EXPECT_LT(simulation.frame().elastic_energy, 1e-9);
      EXPECT_GT(simulation.state().jumps, 0) << scene.dimension << "D, " << load_steps << " increments";
    }
}

TEST(ArcLength, GivesTheSameBitsAfterARestart) { expect_same_bits_after_a_checkpoint(shallow_arch(), 9); }

TEST(ArcLength, EndsAfterTheNumberOfStepsThatTheSceneAllows) {
  Description scene = shallow_arch();
  scene.max_steps = 3;
  const Simulation simulation = run_all(scene);
  EXPECT_TRUE(simulation.is_finished());
  EXPECT_EQ(simulation.state().step, 3);
  EXPECT_LT(simulation.state().load, 1);
}

TEST(ArcLength, GoesStraightToFullLoadWhereNothingSnaps) {
  Description scene = small_bar(3, false);
  const Simulation expected = run_all(scene);
  scene.load_control = LoadControlKind::arc_length;
  scene.load_steps = 3;
  const Simulation simulation = run_all(scene);
  EXPECT_EQ(simulation.state().load, 1);
  const VectorX sag = expected.state().positions - expected.world().rest_positions;
  EXPECT_LT((simulation.state().positions - expected.state().positions).norm(), 1e-6 * sag.norm());
}

/// Prescribed displacements and turns belong to the load factor like forces.
TEST(ArcLength, DrivesTurningSupports) {
  Description scene = small_bar(3, false);
  scene.gravity.setZero();
  FixDescription turned = scene.fixes[0];
  turned.name = "turned";
  turned.where.at = 1;
  turned.rotate = Rotation{.axis = Vector3::UnitX(), .center = {0, 0.125, 0.125}, .degrees = 60};
  scene.fixes.push_back(turned);
  const Simulation expected = run_all(scene);
  ASSERT_TRUE(expected.is_finished());
  scene.load_control = LoadControlKind::arc_length;
  scene.load_steps = 3;
  const Simulation simulation = run_all(scene);
  EXPECT_EQ(simulation.state().load, 1);
  EXPECT_LT((simulation.state().positions - expected.state().positions).norm(), 1e-6);
}

}  // namespace
}  // namespace resilin::testing
