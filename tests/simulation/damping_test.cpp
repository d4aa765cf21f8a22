// Damping against the closed form of small vibrations, and what it must leave alone.

#include <gtest/gtest.h>

#include <numbers>

#include "every_integrator.hpp"
#include "resilin/energy/damping.hpp"
#include "small_scenes.hpp"

namespace resilin::testing {
namespace {

/// A bar that vibrates in its first mode, so little that it is linear.
struct SmallVibration {
  Description scene;
  double angular_frequency;
  VectorX velocities;
};

SmallVibration small_vibration() {
  Description scene = small_bar(3, false);
  scene.gravity.setZero();
  scene.modes = {.count = 1};
  Simulation modal(scene);
  modal.step();
  const VibrationMode& mode = modal.modes()[0];
  scene.modes.reset();
  scene.is_dynamic = true;
  scene.newton.tolerance = 1e-12;
  const VectorX velocities = 1e-5 * mode.shape;
  scene.bodies[0].initial_velocities.assign(velocities.begin(), velocities.end());
  return {scene, std::sqrt(mode.eigenvalue), velocities};
}

/// Runs one damped period; the part of the velocity that is left.
double left_after_a_period(SmallVibration vibration, const DampingDescription& damping,
                           const std::string& integrator, double damping_ratio) {
  const double damped = vibration.angular_frequency * std::sqrt(1 - damping_ratio * damping_ratio);
  vibration.scene.bodies[0].damping = damping;
  vibration.scene.integrator = integrator;
  vibration.scene.end_time = 2 * std::numbers::pi / damped;
  vibration.scene.time_step = vibration.scene.end_time / 400;
  const Simulation simulation = run_all(vibration.scene);
  EXPECT_TRUE(simulation.is_finished());
  return simulation.state().velocities.dot(vibration.velocities) / vibration.velocities.squaredNorm();
}

TEST(RayleighDamping, TakesItsPartOfTheCriticalDamping) {
  const SmallVibration vibration = small_vibration();
  const double w = vibration.angular_frequency;
  const double ratio = 0.05;
  const double left = std::exp(-ratio * w * 2 * std::numbers::pi / (w * std::sqrt(1 - ratio * ratio)));
  for (const std::string integrator : {"bdf2", "tr_bdf2", "newmark", "midpoint"}) {
    // Errors of the step: (2 pi / 400)^2 of the phase, and damping of the scheme (most for bdf2).
    EXPECT_NEAR(left_after_a_period(vibration, {.mass = 2 * ratio * w}, integrator, ratio), left, 2e-3)
        << integrator;
    EXPECT_NEAR(left_after_a_period(vibration, {.stiffness = 2 * ratio / w}, integrator, ratio), left, 2e-3)
        << integrator;
  }
}

TEST(MaterialDamping, IsStiffnessDampingWhereViscositiesAreInProportion) {
  const SmallVibration vibration = small_vibration();
  const double beta = 1e-3;
  const auto& constants = vibration.scene.bodies[0].material.constants;
  const double E = constants.at("youngs_modulus"), nu = constants.at("poissons_ratio");
  const double mu = E / (2 * (1 + nu)), kappa = E / (3 * (1 - 2 * nu));
  const double by_stiffness = left_after_a_period(vibration, {.stiffness = beta}, "tr_bdf2", 0);
  const double by_viscosity = left_after_a_period(
      vibration, {.shear_viscosity = beta * mu, .bulk_viscosity = beta * kappa}, "tr_bdf2", 0);
  // A step moves the bar, of a metre, by some 1e-8 m: rounding of its places is 1e-8 of that.
  EXPECT_NEAR(by_viscosity, by_stiffness, 1e-7 * by_stiffness);
  EXPECT_LT(by_stiffness, 0.999);
}

Description spinning_bar(const std::string& integrator, double time_step) {
  Description scene = small_bar(3, true);
  scene.fixes.clear();
  scene.gravity.setZero();
  scene.integrator = integrator;
  scene.newton.tolerance = 1e-12;
  scene.time_step = time_step;
  scene.end_time = 0.2;
  scene.bodies[0].velocity = {0.3, 0.2, 0.1};
  scene.bodies[0].velocity_gradient(0, 1) = -3;
  scene.bodies[0].velocity_gradient(1, 0) = 3;
  return scene;
}

struct DampedMotionOfEveryIntegrator : WithEveryIntegrator {};
INSTANTIATE_TEST_SUITE_P(Catalogue, DampedMotionOfEveryIntegrator, ::testing::ValuesIn(integrator_names()),
                         name_of_integrator);

TEST_P(DampedMotionOfEveryIntegrator, KeepsMomentumAndHardlySlowsATurn) {
  Description scene = spinning_bar(integrator, 0.002);
  scene.bodies[0].damping = {.stiffness = 2e-3};
  Simulation simulation(scene);
  const Frame start = simulation.frame();
  while (!simulation.is_finished()) ASSERT_EQ(simulation.step().status, StepReport::Status::converged);
  const Frame& end = simulation.frame();
  EXPECT_LT((end.linear_momentum - start.linear_momentum).norm(), 1e-9 * start.linear_momentum.norm());
  const double turned =
      (end.angular_momentum - start.angular_momentum).norm() / start.angular_momentum.norm();
  EXPECT_LT(turned, make_integrator(integrator, "test")->order() == 1 ? 0.02 : 1e-3);
}

TEST_P(DampedMotionOfEveryIntegrator, ConvergesWithTheOrderOfItsIntegrator) {
  const auto end_of = [](const std::string& scheme, double time_step) {
    Description scene = spinning_bar(scheme, time_step);
    scene.end_time = 0.05;
    scene.bodies[0].mesh = make_box({1, 0.5, 0.5}, {2, 1, 1});
    scene.bodies[0].velocity_gradient(0, 0) = 2;
    scene.bodies[0].damping = {.mass = 2, .shear_viscosity = 200, .bulk_viscosity = 100};
    return run_all(scene).state().positions;
  };
  const VectorX exact = end_of("tr_bdf2", 0.05 / 2048);
  const double coarse = (end_of(integrator, 0.05 / 64) - exact).norm();
  const double fine = (end_of(integrator, 0.05 / 128) - exact).norm();
  EXPECT_NEAR(std::log2(coarse / fine), make_integrator(integrator, "test")->order(), 0.25);
}

/// A bar that swings freely, drawn out at first, so that damping alone takes its energy.
Description swinging_bar(const std::string& integrator, double time_step) {
  Description scene = spinning_bar(integrator, time_step);
  scene.bodies[0].mesh = make_box({1, 0.5, 0.5}, {2, 1, 1});
  scene.bodies[0].velocity_gradient(0, 0) = 2;
  scene.bodies[0].damping = {.mass = 2, .shear_viscosity = 200, .bulk_viscosity = 100};
  return scene;
}

/// Energy that the bar lacks at the end beside what damping took, in parts of the latter.
double energy_gap(const std::string& integrator, double time_step) {
  Simulation simulation(swinging_bar(integrator, time_step));
  const double start = simulation.frame().total_energy();
  EXPECT_EQ(simulation.frame().dissipated_energy, 0);
  double before = 0;
  while (!simulation.is_finished()) {
    simulation.step();
    EXPECT_GE(simulation.frame().dissipated_energy, before);
    before = simulation.frame().dissipated_energy;
  }
  EXPECT_GT(before, 0.01 * start);
  return (start - simulation.frame().total_energy() - before) / before;
}

TEST_P(DampedMotionOfEveryIntegrator, AccountsForTheEnergyThatDampingTakes) {
  const double coarse = energy_gap(integrator, 0.002), fine = energy_gap(integrator, 0.001);
  const int order = make_integrator(integrator, "test")->order();
  // The difference is the error of the scheme; backward Euler damps besides.
  EXPECT_LT(std::abs(fine), order == 1 ? 0.5 : 0.02);
  EXPECT_LT(std::abs(fine), std::abs(coarse) * (order == 1 ? 0.6 : 0.3) + 1e-6);
  if (order == 1) {
    EXPECT_GT(fine, 0);
  }
}

TEST(MassDamping, AccountsForTheEnergyThatItTakes) {
  Description scene = swinging_bar("midpoint", 0.001);
  scene.bodies[0].damping = {.mass = 5};
  Simulation simulation(scene);
  const double start = simulation.frame().total_energy();
  while (!simulation.is_finished()) simulation.step();
  const double taken = simulation.frame().dissipated_energy;
  EXPECT_NEAR(start - simulation.frame().total_energy(), taken, 1e-3 * taken);
}

TEST_P(DampedMotionOfEveryIntegrator, GoesOnFromACheckpointWithTheSameBits) {
  Description scene = spinning_bar(integrator, 0.002);
  scene.bodies[0].mass = MassKind::consistent;
  scene.bodies[0].damping = {.mass = 1, .stiffness = 1e-3};
  expect_same_bits_after_a_checkpoint(scene, 3);
}

}  // namespace
}  // namespace resilin::testing
