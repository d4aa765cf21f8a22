// Invariants of each integrator: a tumbling bar without forces (the table of
// docs/theory/integrators.md).

#include <gtest/gtest.h>

#include <map>
#include <numbers>

#include "every_integrator.hpp"
#include "small_scenes.hpp"

namespace resilin::testing {
namespace {

/// A bar of 12 tetrahedra that flies, turns and vibrates.
Description tumbling_bar(const std::string& integrator, double time_step, double end_time) {
  Description scene = small_bar(3, true);
  scene.fixes.clear();
  scene.gravity.setZero();
  scene.integrator = integrator;
  scene.time_step = time_step;
  scene.end_time = end_time;
  scene.newton.tolerance = 1e-13;
  BodyDescription& body = scene.bodies[0];
  body.mesh = make_box({1, 0.5, 0.5}, {2, 1, 1});
  body.material.law = "stable_neo_hookean";
  body.material.constants = {{"youngs_modulus", 1e5}, {"poissons_ratio", 0.3}};
  body.velocity = {0.3, -0.2, 0.1};
  body.velocity_gradient << 0.8, -2, 0.5, 2, 0, 1, -0.5, -1, -0.6;
  return scene;
}

struct Kept {
  double energy = 0;            ///< largest |E - E_0| / E_0
  double angular_momentum = 0;  ///< |L - L_0| / |L_0| at the end
  double linear_momentum = 0;
};

Kept kept_by(const std::string& integrator) {
  Simulation simulation(tumbling_bar(integrator, 0.004, 0.4));
  const Frame start = simulation.frame();
  Kept kept;
  while (!simulation.is_finished()) {
    const StepReport report = simulation.step();
    EXPECT_EQ(report.status, StepReport::Status::converged) << integrator << ": " << report.reason;
    EXPECT_FALSE(report.by_backward_euler || report.removed_energy > 0) << "free flight is left alone";
    const Frame& frame = simulation.frame();
    const double change = std::abs(frame.total_energy() - start.total_energy());
    kept.energy = std::max(kept.energy, change / start.total_energy());
    kept.angular_momentum =
        (frame.angular_momentum - start.angular_momentum).norm() / start.angular_momentum.norm();
    kept.linear_momentum =
        (frame.linear_momentum - start.linear_momentum).norm() / start.linear_momentum.norm();
  }
  return kept;
}

TEST(ATumblingBar, KeepsWhatItsIntegratorPromises) {
  const Kept euler = kept_by("backward_euler");
  const Kept bdf2 = kept_by("bdf2");
  const Kept tr_bdf2 = kept_by("tr_bdf2");
  const Kept newmark = kept_by("newmark");
  const Kept midpoint = kept_by("midpoint");
  for (const Kept& kept : {euler, bdf2, tr_bdf2, newmark, midpoint}) EXPECT_LT(kept.linear_momentum, 1e-11);
  EXPECT_LT(midpoint.angular_momentum, 1e-11);  // round-off of 100 steps
  for (const Kept& other : {euler, bdf2, tr_bdf2, newmark}) EXPECT_GT(other.angular_momentum, 1e-9);
  EXPECT_LT(tr_bdf2.energy, bdf2.energy);
  EXPECT_LT(bdf2.energy, euler.energy);
  EXPECT_GT(euler.energy, 0.03);
  for (const Kept& symmetric : {newmark, midpoint}) EXPECT_LT(symmetric.energy, 1e-4);
}

VectorX positions_after(const std::string& integrator, double time_step) {
  Simulation simulation(tumbling_bar(integrator, time_step, 0.1));
  while (!simulation.is_finished()) simulation.step();
  return simulation.state().positions;
}

TEST(ATumblingBar, ConvergesWithTheOrderOfItsIntegrator) {
  const VectorX exact = positions_after("tr_bdf2", 0.1 / 4096);
  const std::map<std::string, double> orders = {
      {"backward_euler", 1}, {"bdf2", 2}, {"tr_bdf2", 2}, {"newmark", 2}, {"midpoint", 2}};
  for (const auto& [integrator, order] : orders) {
    const double coarse = (positions_after(integrator, 0.1 / 256) - exact).norm();
    const double fine = (positions_after(integrator, 0.1 / 512) - exact).norm();
    EXPECT_NEAR(std::log2(coarse / fine), order, 0.15) << integrator;
  }
}

struct MotionOfEveryIntegrator : WithEveryIntegrator {};
INSTANTIATE_TEST_SUITE_P(Catalogue, MotionOfEveryIntegrator, ::testing::ValuesIn(integrator_names()),
                         name_of_integrator);

TEST_P(MotionOfEveryIntegrator, GoesOnFromACheckpointWithTheSameBits) {
  for (const MassKind mass : {MassKind::lumped, MassKind::consistent}) {
    Description scene = small_bar(3, true);
    scene.integrator = integrator;
    scene.bodies[0].mass = mass;
    SCOPED_TRACE(spelling(mass));
    expect_same_bits_after_a_checkpoint(scene, 3);
  }
}

/// A bar whose wall moves up and down: the middle of a soft bar against the same seen from the wall.
Description shaken_bar(const std::string& integrator) {
  Description scene = small_bar(3, true);
  scene.integrator = integrator;
  scene.gravity.setZero();
  scene.newton.tolerance = 1e-12;
  return scene;
}

struct PrescribedMotionOfEveryIntegrator : WithEveryIntegrator {};
INSTANTIATE_TEST_SUITE_P(Catalogue, PrescribedMotionOfEveryIntegrator,
                         ::testing::ValuesIn(integrator_names()), name_of_integrator);

TEST_P(PrescribedMotionOfEveryIntegrator, IsThatOfTheSceneInPlaceVelocityAndAcceleration) {
  const TimeFunction sine{TimeFunction::Sine{.frequency = 3, .phase = 30}};
  Description scene = shaken_bar(integrator);
  scene.fixes[0].displacement = {0, 0, 0.02};
  scene.fixes[0].time_function = sine;
  scene.fixes[0].velocity = {0.1, 0, 0};
  Simulation simulation(scene);
  for (int step = 0; step < 7; ++step) ASSERT_EQ(simulation.step().status, StepReport::Status::converged);
  const State& state = simulation.state();
  for (const Index node : simulation.world().supports[0].nodes) {
    const Vector3 X = simulation.world().rest_positions.segment<3>(3 * node);
    const Vector3 x = X + Vector3(0.1 * state.time, 0, 0.02 * sine.value(state.time));
    const Vector3 v(0.1, 0, 0.02 * sine.rate(state.time));
    EXPECT_LT((state.positions.segment<3>(3 * node) - x).norm(), 1e-14);
    EXPECT_LT((state.velocities.segment<3>(3 * node) - v).norm(), 1e-13);
  }
}

/// In the frame of a wall that accelerates by a, gravity is -a: the same motion to the order of the scheme.
TEST(PrescribedMotion, ActsLikeGravityInTheFrameOfTheWall) {
  // z = 1/2 a t^2 is no function of the list; a sine about its turning point is, with force a(t) on all
  // nodes.
  const double amplitude = 0.01, frequency = 2;
  const TimeFunction shake{TimeFunction::Sine{.frequency = frequency, .phase = -90, .offset = 1}};
  for (const MassKind mass : {MassKind::lumped, MassKind::consistent}) {
    for (const std::string integrator : {"bdf2", "tr_bdf2", "newmark", "midpoint"}) {
      Description shaken = shaken_bar(integrator);
      shaken.bodies[0].mass = mass;
      shaken.time_step = 5e-4;
      shaken.end_time = 0.1;
      Description pulled = shaken;
      shaken.fixes[0].displacement = {0, 0, amplitude};
      shaken.fixes[0].time_function = shake;
      // The wall's acceleration w^2 A cos(w t) as a body force the other way.
      const double w = 2 * std::numbers::pi * frequency;
      LoadDescription load;
      load.value = {0, 0, -1000 * w * w * amplitude};
      load.time_function.form = TimeFunction::Sine{.frequency = frequency, .phase = 90};
      pulled.loads.push_back(load);
      const Simulation a = run_all(shaken);
      const Simulation b = run_all(pulled);
      ASSERT_TRUE(a.is_finished() && b.is_finished());
      const double wall = amplitude * shake.value(a.state().time);
      const double tip_a = a.frame().probes[0].displacement.z() - wall;
      const double tip_b = b.frame().probes[0].displacement.z();
      EXPECT_NEAR(tip_a, tip_b, 2e-4 * std::abs(tip_b)) << integrator << " " << spelling(mass);
    }
  }
}

TEST(Loads, FollowTheirFunctionOfTime) {
  // Free fall under a force that rises like t: z = F t^3 / 6 m, to second order in the step.
  Description scene = tumbling_bar("tr_bdf2", 0.01, 1);
  scene.bodies[0].velocity.setZero();
  scene.bodies[0].velocity_gradient.setZero();
  scene.probes[0].at = {0, 0, 0};
  LoadDescription load;
  load.value = {0, 0, 600};
  load.time_function.form = TimeFunction::Table{.times = {0, 2}, .values = {0, 2}};
  scene.loads.push_back(load);
  const Simulation simulation = run_all(scene);
  const double density = scene.bodies[0].material.density;
  EXPECT_NEAR(simulation.frame().probes[0].displacement.z(), 100 / density, 1e-4 * 100 / density);
}

Description adaptive_bar(const std::string& integrator, double tolerance) {
  Description scene = small_bar(3, true);
  scene.integrator = integrator;
  scene.time_step = 1e-3;
  scene.end_time = 0.3;
  scene.newton.tolerance = 1e-11;
  scene.adaptive.emplace().tolerance = tolerance;
  LoadDescription load;
  load.value = {0, 0, 20000};
  load.from = 0.1;
  load.until = 0.2;
  scene.loads.push_back(load);
  return scene;
}

struct AdaptiveStepsOfEveryIntegrator : WithEveryIntegrator {};
INSTANTIATE_TEST_SUITE_P(Catalogue, AdaptiveStepsOfEveryIntegrator, ::testing::ValuesIn(integrator_names()),
                         name_of_integrator);

TEST_P(AdaptiveStepsOfEveryIntegrator, MeetTheirToleranceTheEventsAndTheEnd) {
  Description fine = adaptive_bar("tr_bdf2", 1);
  fine.adaptive.reset();
  fine.time_step = 1e-4;
  const Vector3 exact = run_all(fine).frame().probes[0].displacement;
  double coarse_error = 0;
  for (const double tolerance : {1e-3, 1e-5}) {
    Simulation simulation(adaptive_bar(integrator, tolerance));
    bool meets_begin = false, meets_end = false;
    while (!simulation.is_finished()) {
      const StepReport report = simulation.step();
      ASSERT_EQ(report.status, StepReport::Status::converged) << report.reason;
      EXPECT_LE(report.time_error, tolerance * 1.0);  // the bar is 1 m long
      EXPECT_EQ(simulation.frame().time_step, report.time_step);
      meets_begin |= simulation.state().time == 0.1;
      meets_end |= simulation.state().time == 0.2;
    }
    EXPECT_TRUE(meets_begin && meets_end);
    EXPECT_EQ(simulation.state().time, 0.3);
    const double error = (simulation.frame().probes[0].displacement - exact).norm();
    if (tolerance == 1e-3)
      coarse_error = error;
    else
      EXPECT_LT(error, 0.3 * coarse_error);
  }
}

TEST_P(AdaptiveStepsOfEveryIntegrator, GoOnFromACheckpointWithTheSameBits) {
  expect_same_bits_after_a_checkpoint(adaptive_bar(integrator, 1e-4), 5);
}

TEST(AdaptiveSteps, ThatMayNotBeShortEnoughSaySo) {
  Description scene = adaptive_bar("newmark", 1e-9);
  scene.adaptive->min_step = 1e-3;
  Simulation simulation(scene);
  const StepReport report = simulation.step();
  EXPECT_EQ(report.status, StepReport::Status::not_converged);
  EXPECT_NE(report.reason.find("the shortest step has an error of"), std::string::npos) << report.reason;
}

}  // namespace
}  // namespace resilin::testing
