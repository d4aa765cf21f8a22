#include "resilin/fit/inequalities.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <random>

namespace resilin {
namespace {

DenseMatrix random_matrix(Eigen::Index rows, Eigen::Index cols, std::mt19937& random) {
  std::normal_distribution<double> normal;
  return DenseMatrix::NullaryExpr(rows, cols, [&] { return normal(random); });
}

// Karush, Kuhn and Tucker: what is zero pushes outwards, what is positive is at rest.
TEST(NonnegativeLeastSquares, MeetsItsConditions) {
  std::mt19937 random(7);
  for (int i = 0; i < 200; ++i) {
    const DenseMatrix E = random_matrix(4 + i % 5, 1 + i % 12, random);
    const VectorX f = random_matrix(E.rows(), 1, random);
    const VectorX u = nonnegative_least_squares(E, f);
    const VectorX pull = E.transpose() * (f - E * u);
    for (Eigen::Index k = 0; k < u.size(); ++k) {
      EXPECT_GE(u[k], 0);
      EXPECT_LT(pull[k], 1e-9);
      EXPECT_GT(u[k] > 0 ? pull[k] : 0, -1e-9);
    }
  }
}

TEST(LeastSquaresWithInequalities, MeetsItsConditions) {
  std::mt19937 random(11);
  int bound = 0;
  for (int i = 0; i < 300; ++i) {
    const Eigen::Index n = 1 + i % 6, m = i % 20;
    const DenseMatrix A = random_matrix(n + 5, n, random), G = random_matrix(m, n, random);
    const VectorX b = random_matrix(n + 5, 1, random);
    const VectorX inside = random_matrix(n, 1, random);
    const VectorX h = G * inside - VectorX::Constant(m, 0.1);  // so that `inside` is allowed
    BoundedStep step;
    ASSERT_TRUE(least_squares_with_inequalities(A, b, G, h, step));
    const VectorX slack = G * step.x - h;
    EXPECT_GT(m > 0 ? slack.minCoeff() : 0, -1e-8);
    const VectorX gradient = A.transpose() * (A * step.x - b) - G.transpose() * step.multipliers;
    EXPECT_LT(gradient.cwiseAbs().maxCoeff(), 1e-7);
    for (Eigen::Index k = 0; k < m; ++k) {
      EXPECT_GE(step.multipliers[k], 0);
      EXPECT_LT(std::abs(step.multipliers[k] * slack[k]), 1e-7);
      bound += step.multipliers[k] > 0 ? 1 : 0;
    }
  }
  EXPECT_GT(bound, 100);
}

TEST(LeastSquaresWithInequalities, KnowsWhatCannotBe) {
  DenseMatrix G(2, 1);
  G << 1, -1;
  BoundedStep step;
  EXPECT_FALSE(least_squares_with_inequalities(DenseMatrix::Identity(1, 1), VectorX::Zero(1), G,
                                               VectorX::Constant(2, 1.0), step));
}

}  // namespace
}  // namespace resilin
