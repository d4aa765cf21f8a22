// Linear elasticity is solved in one step and says where it stops making sense.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "small_scenes.hpp"

namespace resilin::testing {
namespace {

using ::testing::HasSubstr;

Description linear_bar(int dimension) {
  Description scene = small_bar(dimension, false);
  scene.bodies[0].material.law = "linear_elastic";
  return scene;
}

TEST(LinearProblem, IsRecognised) {
  EXPECT_TRUE(is_linear(World(linear_bar(3))));
  EXPECT_FALSE(is_linear(World(small_bar(3, false))));
  Description scene = linear_bar(3);
  scene.is_dynamic = true;
  EXPECT_FALSE(is_linear(World(scene)));
  scene = linear_bar(3);
  LoadDescription load;
  load.kind = "spring";
  load.stiffness = 10;
  scene.loads.push_back(load);
  EXPECT_TRUE(is_linear(World(scene)));
  scene.loads[0].kind = "pressure";  // follows the surface
  scene.loads[0].pressure = 1;
  EXPECT_FALSE(is_linear(World(scene)));
}

TEST(LinearProblem, TakesOneLinearSolveByEverySolver) {
  for (const std::string solver : {"cholesky", "ldlt", "cg_amg", "cg_ic0", "cg_jacobi"}) {
    Description scene = linear_bar(3);
    scene.solver.kind = solver;
    scene.load_steps = 3;
    Simulation simulation(scene);
    StepReport report = simulation.step();
    EXPECT_EQ(report.status, StepReport::Status::converged) << solver;
    EXPECT_EQ(report.newton.linear_solves, 1) << solver;
    const double third = simulation.frame().probes[0].displacement.z();
    // The secant is the solution: there is nothing left to solve.
    report = simulation.step();
    EXPECT_EQ(report.newton.linear_solves, 0) << solver;
    EXPECT_NEAR(simulation.frame().probes[0].displacement.z(), 2 * third, 1e-7 * std::abs(third)) << solver;
  }
}

TEST(LinearProblem, TellsTheLoadThatInvertsACell) {
  for (const int dimension : {2, 3}) {
    Description scene = linear_bar(dimension);
    // Against the wall: bending alone turns cells, but keeps their volume. Aslant: no two cells are alike.
    scene.gravity = {-240, -3, dimension == 3 ? -2.0 : 0.0};
    Simulation simulation(scene);
    const StepReport report = simulation.step();
    ASSERT_TRUE(report.inversion.has_value());
    EXPECT_GT(report.inversion->load, 0);
    EXPECT_LT(report.inversion->load, 1);
    ASSERT_FALSE(report.warnings.empty());
    EXPECT_THAT(report.warnings.back(), HasSubstr("inverted beyond load factor"));
    // The solution scales with the load: at that load the smallest volume ratio is zero, in that cell.
    const VectorX& X = simulation.world().rest_positions;
    const VectorX u = simulation.state().positions - X;
    const ElasticEnergy& elastic = *simulation.world().bodies[0].domains.front().energy;
    const auto [ratio, cell] = elastic.min_volume_ratio(X + report.inversion->load * u);
    EXPECT_NEAR(ratio, 0, 1e-10);
    EXPECT_EQ(cell, report.inversion->cell);
    EXPECT_GT(elastic.min_volume_ratio(X + 0.99 * report.inversion->load * u).ratio, 0);
    // Half the load is still far from it: no warning, the same load told.
    scene.gravity *= 0.5 * report.inversion->load;
    Simulation half(scene);
    const StepReport half_report = half.step();
    EXPECT_TRUE(half_report.warnings.empty());
    EXPECT_NEAR(half_report.inversion->load, 2, 1e-6);
  }
}

TEST(LinearProblem, HasNoInversionWhereEverythingIsPulled) {
  Description scene = linear_bar(3);
  scene.gravity.setZero();
  FixDescription pull = scene.fixes[0];
  pull.where.kind = Where::Kind::all;
  pull.gradient = 0.5 * Eigen::Matrix3d::Identity();
  scene.fixes = {pull};
  Simulation simulation(scene);
  EXPECT_FALSE(simulation.step().inversion.has_value());
}

}  // namespace
}  // namespace resilin::testing
