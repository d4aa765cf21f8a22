// The weight of a prior: against dense normal equations.
#include "resilin/fit/regularised_problem.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <random>

#include "resilin/mesh/generators.hpp"

namespace resilin {
namespace {

FieldCells sample_cells(int dim) {
  const Mesh mesh = dim == 2 ? make_rectangle({1.2, 0.7}, {4, 3}) : make_box({1.2, 0.7, 0.5}, {3, 2, 1});
  return field_cells(*mesh.find_solid(dim), mesh.vertices, dim);
}

DenseMatrix normal_matrix(Eigen::Index rows, Eigen::Index columns, std::mt19937& random) {
  std::normal_distribution<double> normal(0, 1);
  DenseMatrix A(rows, columns);
  for (Eigen::Index j = 0; j < columns; ++j)
    for (Eigen::Index i = 0; i < rows; ++i) A(i, j) = normal(random);
  return A;
}

/// R column by column.
DenseMatrix dense(const FieldPrior& prior, Eigen::Index n) {
  DenseMatrix R(n, n);
  for (Eigen::Index j = 0; j < n; ++j) R.col(j) = prior.times(VectorX::Unit(n, j));
  return R;
}

TEST(FieldCells, HaveTheVolumeOfTheBodyAndTheGradientOfALinearField) {
  for (const int dim : {2, 3}) {
    const FieldCells cells = sample_cells(dim);
    EXPECT_NEAR(cells.volume, dim == 2 ? 1.2 * 0.7 : 1.2 * 0.7 * 0.5, 1e-12);
    EXPECT_NEAR(VectorX::Map(cells.shares.data(), static_cast<Eigen::Index>(cells.shares.size())).sum(), 1,
                1e-12);
  }
  // A chain of squares: u = x has differences of 0.1 over sides of 0.1, without half a cell at both ends.
  const Mesh mesh = make_quadrilateral_rectangle({1, 0.1}, {10, 1});
  const FieldCells cells = field_cells(*mesh.find_solid(2), mesh.vertices, 2);
  FieldPrior prior(10);
  prior.add(cells, 0, PriorKind::smooth);
  prior.finish();
  VectorX u(10);
  for (int i = 0; i < 10; ++i) u[i] = 0.1 * i + 0.05;
  EXPECT_NEAR(u.dot(prior.times(u)), 0.1 /* L^2 */ * 0.9 /* of mean 1 */, 1e-12);
}

class PriorsAndProblems : public ::testing::TestWithParam<std::tuple<PriorKind, int>> {};

/// R G R = R, with the diagonal of G, and nothing is felt of what is said not to be.
TEST_P(PriorsAndProblems, HaveAGeneralisedInverse) {
  const auto [kind, dim] = GetParam();
  const FieldCells cells = sample_cells(dim);
  const auto n = static_cast<Eigen::Index>(cells.shares.size()) + 2;
  FieldPrior prior(n);
  prior.add(cells, 1, kind);  // one unknown before the field, one behind it
  prior.finish();
  const DenseMatrix R = dense(prior, n), G = prior.inverse_times(DenseMatrix::Identity(n, n));
  EXPECT_LT((R * G * R - R).norm(), 1e-11 * R.norm());
  EXPECT_LT((G - G.transpose()).norm(), 1e-12 * G.norm());
  EXPECT_LT((prior.inverse_diagonal() - G.diagonal()).norm(), 1e-11 * G.diagonal().norm());
  EXPECT_EQ(prior.unfelt().cols(), kind == PriorKind::smooth ? 3 : 2);
  EXPECT_LT((R * prior.unfelt()).norm(), 1e-13 * R.norm());
}

/// Everything by J^T J + a R, for fewer and for more data than unknowns.
TEST_P(PriorsAndProblems, AgreeWithNormalEquations) {
  const auto [kind, dim] = GetParam();
  const FieldCells cells = sample_cells(dim);
  const auto n = static_cast<Eigen::Index>(cells.shares.size()) + 1;
  FieldPrior prior(n);
  prior.add(cells, 0, kind);
  prior.finish();
  std::mt19937 random(3);
  for (const Eigen::Index m : {Eigen::Index{9}, 2 * n}) {
    const DenseMatrix J = normal_matrix(m, n, random);
    const VectorX d = normal_matrix(m, 1, random);
    const RegularisedProblem problem(J, d, prior);
    for (const double a : {1e-3, 0.3, 40.0}) {
      const DenseMatrix normal = J.transpose() * J + a * dense(prior, n), inverse = normal.inverse();
      const VectorX u = inverse * J.transpose() * d;
      const double tolerance = 1e-8;  // tolerance of a normal matrix whose condition is up to 1e6
      EXPECT_LT((problem.solution(a) - u).norm(), tolerance * u.norm());
      const RegularisedProblem::Point point = problem.at(a);
      EXPECT_NEAR(point.misfit, (d - J * u).squaredNorm(), tolerance * d.squaredNorm());
      EXPECT_NEAR(point.roughness, u.dot(prior.times(u)), tolerance * point.roughness);
      EXPECT_NEAR(point.freedom, (J * inverse * J.transpose()).trace(), tolerance * point.freedom);
      const RegularisedProblem::Uncertainty told = problem.uncertainty(a);
      EXPECT_LT((told.variance - inverse.diagonal()).norm(), tolerance * inverse.diagonal().norm());
      const VectorX resolution = (inverse * J.transpose() * J).diagonal();
      EXPECT_LT((told.resolution - resolution).norm(), tolerance * resolution.norm());
      // The curvature against that of a circle through three points of the curve.
      const double h = 0.02;
      const auto place = [&](double by) {
        const RegularisedProblem::Point there = problem.at(a * std::exp(by));
        return Eigen::Vector2d(std::log(there.misfit), std::log(there.roughness));
      };
      const Eigen::Vector2d p = place(-h), q = place(0), r = place(h), first = (r - p) / (2 * h),
                            second = (r - 2 * q + p) / (h * h);
      const double curvature = (first[0] * second[1] - first[1] * second[0]) / std::pow(first.norm(), 3);
      if (first.norm() < 1e-2) continue;  // hardly a curve
      EXPECT_NEAR(point.curvature, curvature, 1e-2 * (std::abs(curvature) + 0.1));
    }
  }
}

INSTANTIATE_TEST_SUITE_P(All, PriorsAndProblems,
                         ::testing::Combine(::testing::Values(PriorKind::smooth, PriorKind::tikhonov,
                                                              PriorKind::both),
                                            ::testing::Values(2, 3)));

/// A smooth truth seen through blurred data of known noise: the corner, the discrepancy principle and cross
/// validation find weights within a factor of 100, over which the field found hardly changes.
TEST(LCurves, HaveTheirCornerWhereTheMisfitIsThatOfTheNoise) {
  const Mesh mesh = make_quadrilateral_rectangle({1, 0.6}, {20, 12});
  const FieldCells cells = field_cells(*mesh.find_solid(2), mesh.vertices, 2);
  const Eigen::Index n = 240, m = 100;
  FieldPrior prior(n);
  prior.add(cells, 0, PriorKind::smooth);
  prior.finish();
  for (unsigned seed = 1; seed <= 5; ++seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> place(0, 1);
    DenseMatrix J(m, n);
    VectorX truth(n);
    for (Eigen::Index k = 0; k < m; ++k) {
      const double x = place(random), y = 0.6 * place(random);
      for (Eigen::Index c = 0; c < n; ++c) {
        const double dx = 0.05 * static_cast<double>(c % 20) + 0.025 - x,
                     dy = 0.05 * static_cast<double>(c / 20) + 0.025 - y;
        J(k, c) = std::exp(-(dx * dx + dy * dy) / 0.01);
        truth[c] = std::sin(6 * (dx + x)) + std::cos(8 * (dy + y));
      }
    }
    const double sigma = 0.01 * (J * truth).norm() / std::sqrt(static_cast<double>(m));
    const VectorX d = J * truth / sigma + normal_matrix(m, 1, random);
    const RegularisedProblem problem(J / sigma, d, prior);
    const double by_noise = discrepancy_strength(problem);
    ASSERT_GT(by_noise, 0);
    const RegularisedProblem::Point there = problem.at(by_noise);
    const double left = static_cast<double>(m) - there.freedom;
    EXPECT_NEAR(there.misfit, left + 2 * std::sqrt(2 * left), 1e-6 * there.misfit);
    const LCurve curve = l_curve(problem);
    ASSERT_GT(curve.corner, 0);
    EXPECT_LT(std::abs(std::log10(curve.corner / by_noise)), 2) << seed;
    EXPECT_LT(std::abs(std::log10(cross_validated_strength(problem) / by_noise)), 2) << seed;
    EXPECT_LT((problem.solution(curve.corner) - truth).norm(), 0.2 * truth.norm()) << seed;
  }
}

}  // namespace
}  // namespace resilin
