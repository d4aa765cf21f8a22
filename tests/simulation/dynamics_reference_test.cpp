// Motion on given meshes against two codes that are not ours (shared/validation).

#include <gtest/gtest.h>

#include "reference_case.hpp"

namespace resilin::testing {
namespace {

TEST(DynamicsReference, BendingColumnByBackwardEuler) {
  RESILIN_NEEDS_SHARED_DATA();
  const nlohmann::json reference = read_validation_case("column_bending_dynamics_3d");
  for (const std::string mass : {"consistent", "lumped"}) {
    SCOPED_TRACE(mass);
    Description description = one_body(3, reference_mesh("meshes/column_2x2x12.msh"),
                                       reference_law_from_young("nh_log", 1.7e7, 0.45));
    description.is_dynamic = true;
    description.time_step = 0.01;
    description.end_time = 0.5;
    description.bodies[0].material.density = 1100;
    description.bodies[0].mass = mass;
    description.bodies[0].velocity_gradient(0, 2) = 5.0 / 3;
    description.fixes.push_back(fix("foot", plane(2, 0)));
    description.probes = {probe("corner", {1, 1, 6})};
    Simulation simulation(description);
    double energy_before = simulation.frame().total_energy();
    for (const auto& row :
         reference["exact_mesh_values"]["bend_ngsolve_implicit_euler_" + mass + "_dt0.01"]) {
      if (row["step"] > 50) break;
      SCOPED_TRACE(row.dump());
      while (simulation.state().step < row["step"]) {
        const StepReport report = simulation.step();
        ASSERT_EQ(report.status, StepReport::Status::converged) << report.reason;
        EXPECT_LT(simulation.frame().total_energy(), energy_before);  // backward Euler dissipates
        energy_before = simulation.frame().total_energy();
      }
      const Frame& frame = simulation.frame();
      if (row["step"] > 0) {
        EXPECT_LT(relative_error(frame.probes[0].displacement, row["u"]["corner"]), exact_mesh_tolerance);
      }
      EXPECT_LT(relative_error(frame.linear_momentum, row["momentum"]), exact_mesh_tolerance);
      const double kinetic = row["kinetic"];
      EXPECT_NEAR(frame.kinetic_energy, kinetic, exact_mesh_tolerance * kinetic);
      const double elastic = row["elastic"];
      EXPECT_NEAR(frame.elastic_energy, elastic, exact_mesh_tolerance * std::max(elastic, kinetic));
    }
    EXPECT_EQ(simulation.state().step, 50);
  }
}

}  // namespace
}  // namespace resilin::testing
