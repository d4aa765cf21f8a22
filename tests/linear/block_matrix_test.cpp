#include "resilin/linear/block_matrix.hpp"

#include <gtest/gtest.h>

#include "bar_problem.hpp"
#include "resilin/core/parallel.hpp"
#include "sample_matrix.hpp"

namespace resilin {
namespace {

using testing::dense;
using testing::sample_matrix;

struct EveryDimension : ::testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(BlockMatrix, EveryDimension, ::testing::Values(2, 3),
                         ::testing::PrintToStringParamName());

TEST_P(EveryDimension, ProductEqualsTheDenseOne) {
  for (const Offset slots_per_chunk : {32768, 60}) {  // one chunk, and many
    const BlockMatrix A = sample_matrix(GetParam(), 120, 1, 9, slots_per_chunk);
    const VectorX x = VectorX::Random(A.num_unknowns());
    VectorX y;
    multiply(A, x, y);
    const VectorX expected = dense(A) * x;
    EXPECT_LT((y - expected).norm(), 1e-14 * expected.norm()) << slots_per_chunk;  // sums of about 20 numbers
  }
}

TEST_P(EveryDimension, ProductHasTheSameBitsForAnyNumberOfThreads) {
  const BlockMatrix A = sample_matrix(GetParam(), 3000, 1, 20, 500);
  ASSERT_GT(A.pattern->product_plan.num_chunks(), 10);
  const VectorX x = VectorX::Random(A.num_unknowns());
  VectorX one, many;
  const int threads_before = num_threads();
  set_num_threads(1);
  multiply(A, x, one);
  set_num_threads(4);
  multiply(A, x, many);
  set_num_threads(threads_before);
  EXPECT_EQ(one, many);
}

TEST_P(EveryDimension, AddsABlockInEitherOrderToTheBaseOrBesideIt) {
  const int dim = GetParam();
  BlockPatternBuilder builder(3);
  builder.add_pair(0, 1);
  BlockMatrix A(dim, std::make_shared<const BlockPattern>(builder.build()));
  const Eigen::Matrix<double, -1, -1, Eigen::RowMajor> block = Eigen::MatrixXd::Random(dim, dim);
  Eigen::MatrixXd expected = Eigen::MatrixXd::Zero(3 * dim, 3 * dim);
  A.add_block(1, 0, block.data());
  A.add_block(0, 2, block.data());
  A.add_block(2, 0, block.data());
  expected.block(dim, 0, dim, dim) = block;
  expected.block(0, dim, dim, dim) = block.transpose();
  expected.block(0, 2 * dim, dim, dim) = expected.block(2 * dim, 0, dim, dim) = block + block.transpose();
  EXPECT_EQ(A.extra.size(), 1U);
  EXPECT_LT((dense(A) - expected).norm(), 1e-15);
  A.set_zero();
  EXPECT_EQ(dense(A).norm(), 0);
}

TEST_P(EveryDimension, KeepsEachPairBesideTheBaseOnce) {
  const int dim = GetParam();
  BlockPatternBuilder builder(200);
  BlockMatrix A(dim, std::make_shared<const BlockPattern>(builder.build()));
  Eigen::MatrixXd expected = Eigen::MatrixXd::Zero(200 * dim, 200 * dim);
  const Eigen::Matrix<double, -1, -1, Eigen::RowMajor> block = Eigen::MatrixXd::Random(dim, dim);
  for (int k = 0; k < 6000; ++k) {  // 3,000 pairs, each in both orders
    const int i = k % 100, j = 100 + (k / 100) % 30;
    const bool is_turned = k >= 3000;
    A.add_block(is_turned ? j : i, is_turned ? i : j, block.data());
    expected.block(i * dim, j * dim, dim, dim) +=
        is_turned ? Eigen::MatrixXd(block.transpose()) : Eigen::MatrixXd(block);
  }
  EXPECT_EQ(A.extra.size(), 3000U);
  expected.bottomLeftCorner(100 * dim, 100 * dim) =
      expected.topRightCorner(100 * dim, 100 * dim).transpose().eval();
  EXPECT_LT((dense(A) - expected).norm(), 1e-12);
  A.set_zero();
  EXPECT_TRUE(A.extra.empty());
  A.add_block(3, 150, block.data());
  EXPECT_EQ(A.extra.size(), 1U);
}

TEST_P(EveryDimension, EliminationLeavesTheIdentityAndTheFreePart) {
  BlockMatrix A = sample_matrix(GetParam(), 60, 1, 15);
  const Eigen::MatrixXd before = dense(A);
  std::vector<std::uint8_t> is_fixed(static_cast<std::size_t>(A.num_unknowns()), 0);
  for (std::size_t k = 0; k < is_fixed.size(); k += 7) is_fixed[k] = 1;
  for (std::size_t k = 30; k < 36; ++k) is_fixed[k] = 1;  // whole nodes too
  eliminate(A, is_fixed);
  const Eigen::MatrixXd after = dense(A);
  for (Eigen::Index i = 0; i < after.rows(); ++i)
    for (Eigen::Index j = 0; j < after.cols(); ++j) {
      const bool is_free =
          is_fixed[static_cast<std::size_t>(i)] == 0 && is_fixed[static_cast<std::size_t>(j)] == 0;
      ASSERT_EQ(after(i, j), is_free ? before(i, j) : (i == j ? 1 : 0)) << i << " " << j;
    }
}

TEST_P(EveryDimension, StiffnessOfTheBarIsSymmetricAndFreeOfRigidMotions) {
  const BarProblem bar = make_bar_problem({.dim = GetParam(), .cells_per_height = 2});
  const Eigen::MatrixXd K = dense(bar.matrix);
  VectorX translation = VectorX::Ones(K.rows());
  for (Eigen::Index k = 0; k < K.rows(); ++k)
    if (bar.is_fixed[static_cast<std::size_t>(k)] != 0) translation[k] = 0;
  const VectorX force = K * translation;
  // Nodes that are two cells off the clamp feel no force from a translation.
  for (Eigen::Index k = 0; k < K.rows(); ++k) {
    const bool is_far = bar.node_positions[k / GetParam() * GetParam()] > 0.9;
    EXPECT_LE(is_far ? std::abs(force[k]) : 0, 1e-13 * K.norm());
  }
  EXPECT_GT(K.ldlt().vectorD().minCoeff(), 0);
}

}  // namespace
}  // namespace resilin
