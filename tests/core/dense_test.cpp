// Decompositions of dense matrices by what defines them.

#include "resilin/core/dense.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <random>

namespace resilin::testing {
namespace {

dense::Matrix random_matrix(Eigen::Index rows, Eigen::Index cols, unsigned seed) {
  std::mt19937 generator(seed);
  std::normal_distribution<double> normal;
  return dense::Matrix::NullaryExpr(rows, cols, [&] { return normal(generator); });
}

struct DenseOfAnySize : ::testing::TestWithParam<std::pair<Eigen::Index, Eigen::Index>> {
  dense::Matrix A = random_matrix(GetParam().first, GetParam().second, 1);
  Eigen::Index rows = A.rows(), cols = A.cols();
};

TEST_P(DenseOfAnySize, ReflectionsGiveTheMatrixBack) {
  const dense::Reflections factors = dense::reflections(A);
  dense::Matrix padded = dense::Matrix::Zero(rows, cols);
  padded.topRows(cols) = dense::upper_triangle(factors);
  EXPECT_LE((dense::times(factors, padded) - A).norm(), 1e-14 * (1 + A.norm()) * static_cast<double>(rows));
  EXPECT_TRUE(factors.order.empty());
}

TEST_P(DenseOfAnySize, PivotedReflectionsGiveItsColumnsBackInTheirOrder) {
  const dense::Reflections factors = dense::pivoted_reflections(A);
  dense::Matrix padded = dense::Matrix::Zero(rows, cols);
  padded.topRows(cols) = dense::upper_triangle(factors);
  const dense::Matrix ordered = dense::times(factors, padded);
  ASSERT_EQ(static_cast<Eigen::Index>(factors.order.size()), cols);
  for (Eigen::Index i = 0; i < cols; ++i) {
    EXPECT_LE((ordered.col(i) - A.col(factors.order[static_cast<std::size_t>(i)])).norm(), 1e-13 * A.norm());
    const double before =
        std::abs(factors.packed(std::max<Eigen::Index>(i - 1, 0), std::max<Eigen::Index>(i - 1, 0)));
    EXPECT_LE(std::abs(factors.packed(i, i)), before * (1 + 1e-12));
  }
}

TEST_P(DenseOfAnySize, QIsOrthogonal) {
  const dense::Reflections factors = dense::pivoted_reflections(A);
  const dense::Matrix X = random_matrix(rows, 3, 2);
  const dense::Matrix turned = dense::times(factors, X);
  EXPECT_LE((turned.transpose() * turned - X.transpose() * X).norm(), 1e-13 * X.squaredNorm());
  EXPECT_LE((dense::transposed_times(factors, turned) - X).norm(), 1e-13 * X.norm());
}

TEST_P(DenseOfAnySize, SingularValuesAreThoseOfItsSquare) {
  if (cols == 0) return;
  const auto [values, right] = dense::singular_values(A);
  const dense::Matrix square = right * values.cwiseAbs2().asDiagonal() * right.transpose();
  EXPECT_LE((square - A.transpose() * A).norm(), 1e-13 * A.squaredNorm());
  EXPECT_TRUE(std::ranges::is_sorted(values, std::greater()));
}

TEST_P(DenseOfAnySize, LeastSquaresLeaveWhatIsOrthogonalToTheColumns) {
  const dense::Matrix B = random_matrix(rows, 2, 4), left = B - A * dense::least_squares(A, B);
  EXPECT_LE((A.transpose() * left).norm(), 1e-12 * (1 + A.norm() * B.norm()));
  EXPECT_EQ(dense::rank(A, 1e-10), cols);
}

TEST_P(DenseOfAnySize, TrianglesAreSolved) {
  const dense::Matrix R = dense::upper_triangle(dense::reflections(A)), X = random_matrix(cols, 2, 3);
  EXPECT_LE((R * dense::solve_upper(R, X) - X).norm(), 1e-10 * (1 + X.norm()));
  EXPECT_LE((R.transpose() * dense::solve_upper_transposed(R, X) - X).norm(), 1e-10 * (1 + X.norm()));
  EXPECT_LE((R.transpose() * dense::solve_lower(R.transpose(), X) - X).norm(), 1e-10 * (1 + X.norm()));
}

using Size = std::pair<Eigen::Index, Eigen::Index>;
INSTANTIATE_TEST_SUITE_P(Sizes, DenseOfAnySize,
                         ::testing::Values(Size{4, 0}, Size{1, 1}, Size{5, 5}, Size{7, 3}, Size{60, 20},
                                           Size{200, 50}));

}  // namespace
}  // namespace resilin::testing
