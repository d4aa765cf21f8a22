// Frequencies against two codes that are not ours (tests/reference), and what modes must have.

#include <gtest/gtest.h>

#include <numbers>

#include "reference_case.hpp"
#include "small_scenes.hpp"

namespace resilin::testing {
namespace {

const std::vector<VibrationMode>& find_all(Simulation& simulation) {
  while (!simulation.is_finished()) {
    const StepReport report = simulation.step();
    EXPECT_EQ(report.status, StepReport::Status::converged) << report.reason;
    if (report.status != StepReport::Status::converged) break;
  }
  return simulation.modes();
}

TEST(VibrationReference, FrequenciesOfTheColumn) {
  const nlohmann::json reference = read_reference("column_bending_dynamics_3d")["frequencies_hz"];
  const std::map<std::string, Mesh> meshes = {{"freq_p1_2x12", reference_mesh("meshes/column_2x2x12.msh")},
                                              {"freq_p1_4x24", make_box({1, 1, 6}, {4, 4, 24})}};
  for (const auto& [name, mesh] : meshes) {
    for (const MassKind mass : {MassKind::consistent, MassKind::lumped}) {
      SCOPED_TRACE(name + " " + spelling(mass));
      Description description = one_body(3, mesh, reference_law_from_young("nh_log", 1.7e7, 0.45));
      description.modes = {.count = 8};
      description.bodies[0].material.density = 1100;
      description.bodies[0].mass = mass;
      description.fixes.push_back(fix("foot", plane(2, 0)));
      Simulation simulation(description);
      const auto& modes = find_all(simulation);
      ASSERT_EQ(modes.size(), 8u);
      for (std::size_t k = 0; k < 8; ++k) {
        const double expected = reference[name][spelling(mass)][k];
        EXPECT_NEAR(modes[k].frequency(), expected, 1e-8 * expected);  // the file's digits; it asks for 1e-6
      }
    }
  }
}

Description vibrating_bar(int dimension, int count) {
  Description scene = small_bar(dimension, false);
  scene.gravity.setZero();
  scene.modes = {.count = count};
  return scene;
}

TEST(AFreeBody, HasItsRigidModesAndTheyAreCalledSo) {
  for (const int dimension : {2, 3}) {
    for (const MassKind mass : {MassKind::lumped, MassKind::consistent}) {
      const int num_rigid = dimension == 3 ? 6 : 3;
      Description scene = vibrating_bar(dimension, num_rigid + 4);
      scene.fixes.clear();
      scene.bodies[0].mass = mass;
      if (dimension == 3) scene.bodies[0].mesh = make_box({1, 0.25, 0.25}, {12, 3, 3});
      Simulation simulation(scene);
      const auto& modes = find_all(simulation);
      Vector3 moved = Vector3::Zero();
      for (std::size_t k = 0; k < modes.size(); ++k) {
        EXPECT_EQ(modes[k].is_rigid, static_cast<int>(k) < num_rigid) << k << ": " << modes[k].eigenvalue;
        if (modes[k].is_rigid) moved += modes[k].effective_mass;
      }
      // Rigid motion takes all of the mass along.
      for (int k = 0; k < dimension; ++k)
        EXPECT_NEAR(moved[k], simulation.world().bodies[0].mass, 1e-6 * moved[k]);
    }
  }
}

TEST(Vibrations, OfAShortMotionHaveTheFrequencyOfTheMode) {
  Description scene = vibrating_bar(3, 1);
  Simulation modal(scene);
  const VibrationMode mode = find_all(modal)[0];
  const double period = 1 / mode.frequency();
  // Thrown along the mode at small speed: back at rest after half a period, the velocity turned round.
  scene.modes.reset();
  scene.is_dynamic = true;
  scene.integrator = "midpoint";
  scene.newton.tolerance = 1e-12;
  scene.time_step = period / 400;
  scene.end_time = period / 2;
  const VectorX velocities = 1e-6 * mode.shape;
  scene.bodies[0].initial_velocities.assign(velocities.begin(), velocities.end());
  const Simulation simulation = run_all(scene);
  EXPECT_LT((simulation.state().velocities + velocities).norm(), 1e-3 * velocities.norm());
}

Simulation bar_under_pull(double traction) {
  Description scene = vibrating_bar(3, 2);
  scene.modes->is_loaded = true;
  scene.bodies[0].mesh = make_box({1, 0.1, 0.1}, {10, 1, 1});
  LoadDescription load;
  load.kind = "traction";
  load.where.kind = Where::Kind::plane;
  load.where.at = 1;
  load.value = {traction, 0, 0};
  scene.loads.push_back(load);
  Simulation simulation(scene);
  find_all(simulation);
  return simulation;
}

TEST(ALoadedBar, IsTunedByItsTension) {
  const double slack = bar_under_pull(0).modes()[0].frequency();
  EXPECT_GT(bar_under_pull(2000).modes()[0].frequency(), 1.05 * slack);
  EXPECT_LT(bar_under_pull(-500).modes()[0].frequency(), 0.99 * slack);
}

TEST(ACompressedBar, HasUnstableModes) {
  const World world(vibrating_bar(3, 3));
  VectorX pressed = world.rest_positions;
  for (Index node = 0; node < world.num_nodes(); ++node) pressed[3 * node] *= 0.8;
  StepReport report;
  const auto modes = find_modes(world, pressed, 0, report, {});
  ASSERT_EQ(report.status, StepReport::Status::converged) << report.reason;
  EXPECT_TRUE(modes[0].is_unstable()) << modes[0].eigenvalue;
  EXPECT_EQ(modes[0].frequency(), 0);
}

TEST(Modes, GoOnFromACheckpointWithTheSameBits) {
  const Description scene = vibrating_bar(3, 5);
  Simulation unbroken(scene);
  Simulation first(scene);
  for (int step = 0; step < 2; ++step) first.step();
  Simulation second(scene);
  second.resume_from(deserialize_state(serialize(first.state()), "checkpoint.bin"), "checkpoint.bin");
  find_all(unbroken);
  find_all(second);
  EXPECT_EQ(serialize(unbroken.state()), serialize(second.state()));
  EXPECT_EQ(unbroken.frame().mode->number, 5);
  EXPECT_EQ(unbroken.frame().mode->frequency, second.frame().mode->frequency);
}

TEST(Modes, AreDrawnATenthOfTheBodyAwayFromRest) {
  Simulation simulation(vibrating_bar(3, 1));
  find_all(simulation);
  const VectorX motion = simulation.state().positions - simulation.world().rest_positions;
  double farthest = 0;
  for (Index node = 0; node < simulation.world().num_nodes(); ++node)
    farthest = std::max(farthest, motion.segment<3>(3 * node).norm());
  EXPECT_NEAR(farthest, 0.1, 1e-12);
}

TEST(Modes, MoreThanThereAreUnknownsAreRefused) {
  Description scene = vibrating_bar(3, 100000);
  try {
    const Simulation simulation(scene);
    FAIL();
  } catch (const std::exception& error) {
    EXPECT_NE(std::string(error.what()).find("simulation.modes.count: expected from 1 to"),
              std::string::npos);
  }
}

}  // namespace
}  // namespace resilin::testing
