// A pressure that follows its surface: when it has a potential, and what Newton does when it has none.

#include <gtest/gtest.h>

#include "resilin/simulation/potential.hpp"
#include "small_scenes.hpp"

namespace resilin::testing {
namespace {

LoadDescription pressure_on(const Where& where, double pressure) {
  LoadDescription load;
  load.kind = "pressure";
  load.where = where;
  load.pressure = pressure;
  return load;
}

Where plane(int axis, double at) {
  Where where;
  where.kind = Where::Kind::plane;
  where.axis = axis;
  where.at = at;
  return where;
}

/// A bar of 1 x 0.25 x 0.25 m (2D: 1 x 0.25 m), clamped at x = 0, pressed from above.
Description pressed_bar(int dimension, double pressure) {
  Description scene = small_bar(dimension, false);
  scene.gravity.setZero();
  scene.bodies[0].material.law = "neo_hookean";
  scene.loads = {pressure_on(plane(dimension - 1, 0.25), pressure)};
  return scene;
}

bool has_potential(const Description& scene) {
  const World world(scene);
  VectorX x = world.rest_positions;
  for (Eigen::Index i = 0; i < x.size(); ++i)
    if (world.is_fixed[static_cast<std::size_t>(i)] == 0)
      x[i] += 0.01 * std::sin(3.0 * static_cast<double>(i));
  return Potential::at(world, {.time = 0, .load = 1}, x).has_potential(x);
}

TEST(FollowerPressure, HasAPotentialOnAClosedSurfaceOrWithHeldEdgesOnly) {
  for (const int dimension : {2, 3}) {
    SCOPED_TRACE(dimension);
    EXPECT_FALSE(has_potential(pressed_bar(dimension, 1000)));
    Description scene = pressed_bar(dimension, 1000);
    scene.loads.clear();
    EXPECT_TRUE(has_potential(scene));
    // All around, the clamped end among it.
    scene.loads = {pressure_on({}, 1000)};
    EXPECT_TRUE(has_potential(scene));
    // From above, the rim of the pressed face held.
    scene = pressed_bar(dimension, 1000);
    for (int axis = 0; axis + 1 < dimension; ++axis) {
      for (const double side : {0.0, axis == 0 ? 1.0 : 0.25}) {
        scene.fixes.push_back(scene.fixes[0]);
        scene.fixes.back().where = plane(axis, side);
      }
    }
    EXPECT_TRUE(has_potential(scene));
  }
}

/// By the symmetric part of the tangent alone these take 40 iterations to some hundreds, or do not converge.
/// In the last step of the softest bar a search for a jump, in two halves, counts too.
TEST(FollowerPressure, ConvergesQuicklyWhereItHasNoPotential) {
  for (const int dimension : {2, 3}) {
    for (const double pressure : {200.0, 1000.0, 3000.0}) {
      SCOPED_TRACE(std::to_string(dimension) + "D, " + std::to_string(pressure) + " Pa");
      Description scene = pressed_bar(dimension, pressure);
      scene.newton.tolerance = 1e-10;
      scene.load_steps = 4;
      Simulation simulation(scene);
      while (!simulation.is_finished()) {
        const StepReport report = simulation.step();
        ASSERT_EQ(report.status, StepReport::Status::converged) << report.reason;
        EXPECT_EQ(report.failed_attempts, 0);
        EXPECT_LE(report.newton.residual, 1e-10 * report.newton.force_scale);
        const bool looks_for_a_jump = dimension == 2 && pressure == 3000 && simulation.is_finished();
        EXPECT_LE(report.newton.iterations, looks_for_a_jump ? 36 : 12);
      }
    }
  }
}

/// The wall carries what the pressure does on the deformed surface.
TEST(FollowerPressure, IsBalancedByTheWall) {
  const Simulation simulation = run_all(pressed_bar(3, 1000));
  ASSERT_TRUE(simulation.is_finished());
  const World& world = simulation.world();
  VectorX force = VectorX::Zero(world.rest_positions.size());
  for (const auto& term : world.terms) {
    if (term->properties().category != EnergyCategory::external) continue;
    term->add_gradient(simulation.state().positions, {.time = 0, .load = 1}, force);
  }
  Vector3 sum = Vector3::Zero();
  for (Index i = 0; i < world.num_nodes(); ++i) sum += force.segment<3>(3 * i);
  EXPECT_LT((simulation.frame().reactions[0].second - sum).norm(), 1e-6 * sum.norm());
}

}  // namespace
}  // namespace resilin::testing
