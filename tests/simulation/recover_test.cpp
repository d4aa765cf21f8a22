// Bodies that start scrambled, collapsed, mirrored or torn out must come back to rest.

#include <gtest/gtest.h>

#include <cmath>

#include "reference_case.hpp"
#include "resilin/energy/inertia.hpp"

namespace resilin::testing {
namespace {

Description broken_start(const nlohmann::json& reference, const std::string& law,
                         const nlohmann::json& start) {
  const double mu = reference["parameters"]["mu"];
  const double lambda = reference["parameters"]["lam"];
  Description description = one_body(3, reference_mesh(reference["mesh"]), reference_law(law, mu, lambda));
  description.fixes.push_back(fix("wall", plane(0, 0)));
  BodyDescription& body = description.bodies[0];
  for (std::size_t v = 0; v < start.size(); ++v) {
    const Vector3& rest = body.mesh.vertices[v];
    for (int k = 0; k < 3; ++k) {
      const double broken = start[v][static_cast<std::size_t>(k)];
      body.initial_positions.push_back(rest.x() == 0 ? rest[k] : broken);  // held vertices start in place
    }
  }
  return description;
}

TEST(Recover, StaticsEndsAtRestFromEveryStart) {
  const nlohmann::json reference = read_reference("recover");
  for (const std::string law : {"snh", "snh_log"}) {
    for (const auto& [name, start] : reference["starts"].items()) {
      SCOPED_TRACE(law + ", " + name);
      Simulation simulation(broken_start(reference, law, start));
      const StepReport report = simulation.step();
      EXPECT_EQ(report.status, StepReport::Status::converged) << report.reason;
      const VectorX distance = simulation.state().positions - simulation.world().rest_positions;
      EXPECT_LT(distance.cwiseAbs().maxCoeff(), 1e-5);
      EXPECT_LT(std::abs(simulation.frame().elastic_energy), 1e-10);
      RecordProperty(law + ", " + name, report.newton.iterations);
    }
  }
}

/// A step cut short must not pump energy in: never above the incremental potential of staying put, which for
/// a body at rest is its elastic energy alone.
TEST(Recover, TruncatedStepsNeverRaiseTheEnergyAndTheBodyComesBack) {
  const nlohmann::json reference = read_reference("recover");
  for (const std::string law : {"snh", "snh_log"}) {
    for (const auto& [name, start] : reference["starts"].items()) {
      for (const int iterations : {1, 2, 5}) {
        SCOPED_TRACE(law + ", " + name + ", " + std::to_string(iterations) + " iterations");
        Description description = broken_start(reference, law, start);
        description.is_dynamic = true;
        description.time_step = 0.1;
        description.end_time = 2;
        // So light that inertia does not carry the converged motion through inverted states after 20 steps.
        description.bodies[0].material.density = 0.1;
        description.newton.max_iterations = iterations;
        Simulation simulation(description);
        const World& world = simulation.world();
        for (int step = 0; step < 20; ++step) {
          const State before = simulation.state();
          const double potential_before = simulation.frame().elastic_energy;
          simulation.step();
          const State& after = simulation.state();
          ASSERT_TRUE(after.positions.allFinite());
          // 1/(2 dt^2) |x - x~|^2 + Psi at x, and at the old positions.
          const double dt = world.time_step;
          const MassDistance inertia(EnergyCategory::inertia, *world.mass,
                                     before.positions + dt * before.velocities, dt * dt);
          const double staying = inertia.value(before.positions, {}) + potential_before;
          const double moving = inertia.value(after.positions, {}) + simulation.frame().elastic_energy;
          ASSERT_LE(moving, staying * (1 + 1e-12));
        }
        if (iterations == 5) {
          EXPECT_GT(simulation.frame().min_volume_ratio, 0);
        }
      }
    }
  }
}

}  // namespace
}  // namespace resilin::testing
