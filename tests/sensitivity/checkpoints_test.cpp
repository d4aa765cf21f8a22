#include "derivative_checks.hpp"
#include "every_integrator.hpp"
#include "resilin/core/memory.hpp"
#include "small_scenes.hpp"

namespace resilin::testing {
namespace {

using Checkpoints = WithEveryIntegrator;

Description thrown_bar(const std::string& integrator) {
  Description scene = small_bar(3, true);
  scene.integrator = integrator;
  scene.bodies[0].mesh = make_box({1, 0.25, 0.25}, {4, 1, 1});
  scene.bodies[0].velocity_gradient(2, 0) = 2;
  return scene;
}

TEST_P(Checkpoints, ChangeNoBitOfAGradient) {
  const Description scene = thrown_bar(integrator);
  const std::vector<std::string> wrt = {"body.body.material.youngs_modulus", "body.body.density",
                                        "body.body.initial_velocities"};
  const auto whole = Derivatives::run(scene, wrt);
  ASSERT_EQ(whole->num_frames(), 11);
  const std::vector<FrameChange> slopes = random_slopes(*whole);
  const std::vector<VectorX> gradient = whole->transposed(slopes);
  for (const int checkpoints : {1, 3, 100}) {
    const auto run = Derivatives::run(scene, wrt, {.checkpoints = checkpoints, .goes_on = {}});
    EXPECT_EQ(run->transposed(slopes), gradient) << checkpoints;
    for (int k = 0; k < run->num_frames(); ++k) EXPECT_EQ(run->positions(k), whole->positions(k)) << k;
  }
}

INSTANTIATE_TEST_SUITE_P(Catalogue, Checkpoints, ::testing::ValuesIn(integrator_names()), name_of_integrator);

TEST(Trajectory, IsThatOfAPlainRun) {
  const Description scene = thrown_bar("tr_bdf2");
  const auto run = Derivatives::run(scene, {});
  Simulation plain(scene);
  for (int k = 1; !plain.is_finished(); ++k) {
    plain.step();
    EXPECT_LE((run->positions(k) - plain.state().positions).cwiseAbs().maxCoeff(), 1e-15);
  }
}

/// Three numbers for each vertex, and at the starts of chunks three more.
TEST(Trajectory, KeepsTwentySixBytesForAVertexAndStep) {
  Description scene = small_bar(3, true);
  scene.bodies[0].mesh = make_box({1, 0.5, 0.5}, {16, 8, 8});
  double bytes[2], steps[2] = {49, 196};
  Index vertices = 1;
  for (std::size_t k = 0; k < 2; ++k) {
    scene.end_time = steps[k] * scene.time_step;
    const double before = heap_bytes();
    const auto run = Derivatives::run(scene, {"body.body.density"});
    bytes[k] = heap_bytes() - before;
    vertices = run->world().num_nodes();
  }
  if (bytes[0] == 0) GTEST_SKIP() << "the heap does not say what it holds";
  EXPECT_LT((bytes[1] - bytes[0]) / (vertices * (steps[1] - steps[0])), 26);
}

}  // namespace
}  // namespace resilin::testing
