// Motion on given meshes against two codes that are not ours (tests/reference).

#include <gtest/gtest.h>

#include "reference_case.hpp"

namespace resilin::testing {
namespace {

/// The column of the reference case, its foot held, thrown sideways.
Description column(const std::string& integrator, const std::string& mass, double time_step) {
  Description description = one_body(3, reference_mesh("meshes/column_2x2x12.msh"),
                                     reference_law_from_young("nh_log", 1.7e7, 0.45));
  description.is_dynamic = true;
  description.time_step = time_step;
  description.end_time = 0.5;
  description.integrator = integrator;
  description.bodies[0].material.density = 1100;
  description.bodies[0].mass = find_spelled<MassKind>(mass).value();
  description.bodies[0].velocity_gradient(0, 2) = 5.0 / 3;
  description.fixes.push_back(fix("foot", plane(2, 0)));
  description.probes = {probe("corner", {1, 1, 6})};
  return description;
}

void expect_row(const Frame& frame, const nlohmann::json& row) {
  SCOPED_TRACE(row.dump());
  if (row["step"] > 0) {
    EXPECT_LT(relative_error(frame.probes[0].displacement, row["u"]["corner"]), exact_mesh_tolerance);
  }
  EXPECT_LT(relative_error(frame.linear_momentum, row["momentum"]), exact_mesh_tolerance);
  const double kinetic = row["kinetic"];
  EXPECT_NEAR(frame.kinetic_energy, kinetic, exact_mesh_tolerance * kinetic);
  const double elastic = row["elastic"];
  EXPECT_NEAR(frame.elastic_energy, elastic, exact_mesh_tolerance * std::max(elastic, kinetic));
}

struct ReferenceRun {
  std::string scheme;  ///< as the file calls it
  std::string integrator;
  std::string mass;
  std::string time_step;
};

/// All rows of the file up to half a second, where the motion is smooth.
TEST(DynamicsReference, BendingColumnByEveryScheme) {
  const nlohmann::json reference = read_reference("column_bending_dynamics_3d");
  const std::vector<ReferenceRun> runs = {
      {"implicit_euler", "backward_euler", "consistent", "0.01"},
      {"implicit_euler", "backward_euler", "lumped", "0.01"},
      {"bdf2", "bdf2", "consistent", "0.01"},
      {"newmark", "newmark", "consistent", "0.01"},
      {"newmark", "newmark", "consistent", "0.005"},
      {"newmark", "newmark", "consistent", "0.0025"},
      {"newmark", "newmark", "consistent", "0.00125"},
  };
  for (const ReferenceRun& run : runs) {
    const std::string key = "bend_ngsolve_" + run.scheme + "_" + run.mass + "_dt" + run.time_step;
    SCOPED_TRACE(key);
    const double time_step = std::stod(run.time_step);
    Simulation simulation(column(run.integrator, run.mass, time_step));
    const double start_energy = simulation.frame().total_energy();
    double energy_before = start_energy;
    for (const auto& row : reference["exact_mesh_values"][key]) {
      if (row["step"].get<int>() * time_step > 0.5 + 1e-9) break;
      while (simulation.state().step < row["step"]) {
        const StepReport report = simulation.step();
        ASSERT_EQ(report.status, StepReport::Status::converged) << report.reason;
        const double energy = simulation.frame().total_energy();
        if (run.integrator == "backward_euler") {
          EXPECT_LT(energy, energy_before);
        }
        if (run.integrator == "newmark") {
          EXPECT_NEAR(energy, start_energy, 4e-4 * start_energy);
        }
        energy_before = energy;
      }
      expect_row(simulation.frame(), row);
    }
    EXPECT_TRUE(simulation.state().step >= 40);
  }
}

/// The limit of small steps that the file gives, u_x at 0.1 s, is met by all.
TEST(DynamicsReference, SecondOrderSchemesMeetTheLimitOfSmallSteps) {
  const nlohmann::json reference = read_reference("column_bending_dynamics_3d");
  const double expected =
      reference["exact_mesh_values"]["bend_ngsolve_newmark_consistent_dt0.00125"][0]["u"]["corner"][0];
  for (const std::string integrator : {"bdf2", "tr_bdf2", "newmark", "midpoint"}) {
    Description description = column(integrator, "consistent", 0.00125);
    description.end_time = 0.1;
    Simulation simulation(description);
    EXPECT_NEAR(run_to_end(simulation).probes[0].displacement.x(), expected, 1.2e-3) << integrator;
  }
}

}  // namespace
}  // namespace resilin::testing
