// Solutions of the steps of a motion, one after another: what they keep of those before changes no result but
// within what they are solved to.

#include "derivative_checks.hpp"
#include "resilin/core/parallel.hpp"
#include "resilin/mesh/generators.hpp"
#include "resilin/sensitivity/earlier_solutions.hpp"
#include "small_scenes.hpp"

namespace resilin::testing {
namespace {

const std::vector<std::string> of_bar = {"body.body.material.youngs_modulus", "body.body.density",
                                         "body.body.initial_velocities"};

/// A soft bar that is thrown and sags by a third of its length: its stiffness changes from step to step.
Description flung_bar(const std::string& solver, double tolerance) {
  Description scene = small_bar(3, true);
  scene.solver.kind = solver;
  scene.newton.tolerance = tolerance;
  scene.end_time = 0.5;
  scene.bodies[0].velocity_gradient(2, 0) = 2;
  return scene;
}

/// How far products by the transposed and by the derivative itself are apart, which are solved for one by
/// one.
double mismatch(const Description& scene) {
  const auto run = Derivatives::run(scene, of_bar);
  const std::vector<FrameChange> slopes = random_slopes(*run);
  const std::vector<VectorX> gradient = run->transposed(slopes);
  double largest = 0;
  for (std::size_t i = 0; i < of_bar.size(); ++i) {
    const std::vector<VectorX> change = change_of_one(*run, i);
    const std::vector<FrameChange> frames = run->forward(change);
    double scale = 0;
    for (std::size_t k = 0; k < slopes.size(); ++k)
      scale += slopes[k].positions.norm() * frames[k].positions.norm() +
               slopes[k].velocities.norm() * frames[k].velocities.norm();
    largest = std::max(largest, std::abs(product(slopes, frames) - gradient[i].dot(change[i])) / scale);
  }
  return largest;
}

class AdjointsOfSteps : public ::testing::TestWithParam<const char*> {};

TEST_P(AdjointsOfSteps, AreAsRightAsTheStepsThemselves) {
  for (const double tolerance : {1e-6, 1e-8}) {
    SCOPED_TRACE(tolerance);
    EXPECT_LT(mismatch(flung_bar(GetParam(), tolerance)), 0.1 * tolerance);
  }
  EXPECT_LT(mismatch(flung_bar(GetParam(), 1e-12)), 1e-11);
}

TEST_P(AdjointsOfSteps, DoNotDependOnWhatWasAskedBefore) {
  const auto run = Derivatives::run(flung_bar(GetParam(), 1e-8), of_bar);
  const std::vector<FrameChange> slopes = random_slopes(*run);
  const std::vector<VectorX> change = change_of_one(*run, 0);
  const std::vector<VectorX> gradient = run->transposed(slopes);
  const VectorX end = run->forward(change).back().positions;
  std::vector<FrameChange> others = random_slopes(*run);
  for (FrameChange& of : others) of.positions.reverseInPlace();
  run->transposed(others);
  EXPECT_EQ(run->transposed(slopes), gradient);
  EXPECT_EQ(run->forward(change).back().positions, end);
}

TEST_P(AdjointsOfSteps, HaveTheSameBitsForAnyNumberOfThreadsAndOfCheckpoints) {
  Description scene = flung_bar(GetParam(), 1e-8);
  scene.end_time = 0.2;
  scene.bodies[0].mesh = make_box({1, 0.25, 0.25}, {24, 6, 6});
  const int before = num_threads();
  std::vector<VectorX> expected;
  for (const int threads : {1, 2, 3}) {
    set_num_threads(threads);
    const auto run = Derivatives::run(scene, of_bar, {.checkpoints = threads - 1, .goes_on = {}});
    const std::vector<VectorX> gradient = run->transposed(random_slopes(*run));
    if (threads == 1) expected = gradient;
    EXPECT_EQ(gradient, expected) << threads << " threads";
  }
  set_num_threads(before);
}

INSTANTIATE_TEST_SUITE_P(Solvers, AdjointsOfSteps, ::testing::Values("cg_ic0", "multifrontal", "auto"));

/// Blocks on a diagonal, definite and of different sizes.
BlockMatrix sample_diagonal(Index num_nodes) {
  BlockMatrix A(2, std::make_shared<const BlockPattern>(BlockPatternBuilder(num_nodes).build()));
  for (Index i = 0; i < num_nodes; ++i) {
    const double blocks[] = {2.0 + i, 0.5, 0.5, 1.0 + i * i};
    std::ranges::copy(blocks, A.block(A.pattern->slot(i, i)));
  }
  return A;
}

TEST(EarlierSolutions, BeginAtTheirNearestCombination) {
  const BlockMatrix A = sample_diagonal(10);
  const VectorX first = random_numbers(20, 1), second = first + 1e-4 * random_numbers(20, 2);
  EarlierSolutions earlier;
  VectorX b;
  multiply(A, first, b);
  EXPECT_EQ(earlier.nearest(A, b).size(), 0);  // there are none
  earlier.take(first);
  earlier.take(second);
  const VectorX wanted = 3 * second - 2.5 * first;
  multiply(A, wanted, b);
  // Differences of solutions that agree in four digits have that many less.
  EXPECT_LT((earlier.nearest(A, b) - wanted).norm(), 1e-11 * wanted.norm());
}

TEST(EarlierSolutions, AreNoBeginningWhereTheyDoNotHelp) {
  const BlockMatrix A = sample_diagonal(2);
  EarlierSolutions earlier;
  earlier.take(VectorX::Unit(4, 0));
  earlier.take(VectorX::Zero(4));
  EXPECT_EQ(earlier.nearest(A, VectorX::Unit(4, 3)).size(), 0);
}

}  // namespace
}  // namespace resilin::testing
