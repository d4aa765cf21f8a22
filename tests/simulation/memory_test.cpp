// How much a large body holds while its equilibrium is sought.

#include <gtest/gtest.h>

#include "resilin/core/memory.hpp"
#include "resilin/core/parallel.hpp"
#include "resilin/simulation/simulation.hpp"
#include "small_scenes.hpp"

namespace resilin::testing {
namespace {

/// So many cells that their geometry is made anew where it is needed. Counted between two iterations, when
/// vectors of solves and line searches are given back: 781, so that two vectors more are too much.
TEST(Memory, OfALinearBodyAtRestIsAFewVectorsBesideTheMatrixAndItsMultigrid) {
  if (heap_bytes() == 0) GTEST_SKIP() << "the allocator does not count its bytes";
  const int threads_before = num_threads();
  set_num_threads(1);
  Description scene = small_bar(3, false);
  scene.bodies[0].mesh = make_box({4, 1, 1}, {52, 13, 13});
  scene.bodies[0].element = "P1";
  scene.bodies[0].mass = MassKind::consistent;
  scene.gravity *= 0.01;
  scene.solver.kind = "cg_amg";
  const double before = heap_bytes();
  Simulation simulation(std::move(scene));
  double held = 0;
  simulation.step([&](const NewtonReport&) {
    held = heap_bytes() - before;
    return false;
  });
  set_num_threads(threads_before);
  EXPECT_GT(held, 0);
  EXPECT_LT(held / simulation.world().num_free_unknowns(), 790);
}

}  // namespace
}  // namespace resilin::testing
