// Oddities on the way are told at the end of a run, where nothing of them is left.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "resilin/results/run.hpp"
#include "small_scenes.hpp"

namespace resilin::testing {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

/// Thrown hard on a floor, by a law that allows it, and whole again in the end.
TEST(OnTheWay, CellsThatWereInsideOutAreTold) {
  for (const int dimension : {2, 3}) {
    Description scene = small_bar(dimension, true);
    scene.fixes.clear();
    scene.bodies[0].material.law = "corotated";
    scene.bodies[0].velocity = -20 * Vector3::Unit(dimension - 1);
    ColliderDescription floor;
    floor.kind = "half_space";
    floor.shape.point = -0.05 * Vector3::Unit(dimension - 1);
    floor.shape.normal = Vector3::Unit(dimension - 1);
    scene.colliders = {floor};
    scene.integrator = "backward_euler";
    scene.time_step = 0.005;
    scene.end_time = 0.5;
    Simulation simulation(scene);
    const RunOutcome outcome = run_to_end(simulation, {});
    const SmallestVolume& smallest = simulation.most_strained().smallest_volume;
    ASSERT_LE(smallest.ratio, 0);
    EXPECT_GT(simulation.frame().min_volume_ratio, 0);
    EXPECT_GT(smallest.time, 0);
    EXPECT_LT(smallest.time, scene.end_time);
    EXPECT_THAT(::testing::PrintToString(outcome.warnings),
                AllOf(HasSubstr("inverted during the run, cell " + std::to_string(smallest.cell)),
                      HasSubstr("at t = ")));
  }
}

}  // namespace
}  // namespace resilin::testing
