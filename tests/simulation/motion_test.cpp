// What each integrator keeps of a motion: a tumbling bar without forces (the table of
// docs/theory/integrators.md).

#include <gtest/gtest.h>

#include <map>

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

TEST(EveryIntegrator, GoesOnFromACheckpointWithTheSameBits) {
  for (const std::string& integrator : integrator_names()) {
    for (const std::string mass : {"lumped", "consistent"}) {
      Description scene = small_bar(3, true);
      scene.integrator = integrator;
      scene.bodies[0].mass = mass;
      Simulation unbroken(scene);
      Simulation first(scene);
      for (int step = 0; step < 3; ++step) first.step();
      Simulation second(scene);
      second.resume_from(deserialize_state(serialize(first.state()), "checkpoint.bin"), "checkpoint.bin");
      for (int step = 0; step < 6; ++step) unbroken.step();
      for (int step = 0; step < 3; ++step) second.step();
      EXPECT_EQ(serialize(unbroken.state()), serialize(second.state())) << integrator << " " << mass;
    }
  }
}

}  // namespace
}  // namespace resilin::testing
