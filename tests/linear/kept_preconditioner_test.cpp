// Within a search the preconditioner of one matrix serves those that are near to it.

#include <gtest/gtest.h>

#include <memory>
#include <string>

#include "bar_problem.hpp"
#include "resilin/linear/linear_solver.hpp"
#include "resilin/linear/matrix_sample.hpp"

namespace resilin {
namespace {

struct KeptPreconditioner : ::testing::TestWithParam<std::string> {
  const BarProblem bar = make_bar_problem({.cells_per_height = 5, .poissons_ratio = 0.3});

  std::unique_ptr<LinearSolver> make() const {
    return make_linear_solver({.kind = GetParam()}, bar.matrix.num_unknowns());
  }
  /// The solution for this matrix, from zero, to 1e-9; checked.
  VectorX solution(LinearSolver& solver, const BlockMatrix& A) const {
    solver.analyze(A, bar.node_positions);
    EXPECT_EQ(solver.factorize(A).status, LinearReport::Status::ok);
    VectorX x = VectorX::Zero(bar.right_side.size()), Ax;
    EXPECT_EQ(solver.solve(A, bar.right_side, x, 1e-9).status, LinearReport::Status::ok);
    multiply(A, x, Ax);
    EXPECT_LT((bar.right_side - Ax).norm(), 1.1e-9 * bar.right_side.norm());
    return x;
  }
  /// The free part of the diagonal is raised here and there by a share of itself.
  BlockMatrix changed(double share) const {
    BlockMatrix A = bar.matrix;
    for (Index i = 0; i < A.num_nodes(); i += 3)
      for (int d = 0; d < A.dim; ++d)
        if (bar.is_fixed[static_cast<std::size_t>(i * A.dim + d)] == 0)
          A.block(A.pattern->row_begin[static_cast<std::size_t>(i)])[d * (A.dim + 1)] *= 1 + share;
    return A;
  }
};
INSTANTIATE_TEST_SUITE_P(Iterative, KeptPreconditioner, ::testing::Values("cg_amg", "cg_ic0", "cg_jacobi"),
                         [](const auto& entry) { return entry.param; });

TEST_P(KeptPreconditioner, ServesMatricesThatAreNear) {
  const BlockMatrix near = changed(0.01);
  const VectorX fresh = solution(*make(), near);
  const auto solver = make();
  solution(*solver, bar.matrix);
  EXPECT_NE(solution(*solver, near), fresh) << "it was made anew: the test shows nothing";
}

TEST_P(KeptPreconditioner, IsMadeAnewForAMatrixFarAway) {
  const BlockMatrix far = changed(0.5);
  const VectorX fresh = solution(*make(), far);
  const auto solver = make();
  solution(*solver, bar.matrix);
  EXPECT_EQ(solution(*solver, far), fresh);
}

TEST_P(KeptPreconditioner, EndsWithItsSearchAndWithItsMemory) {
  const BlockMatrix near = changed(0.01);
  const VectorX fresh = solution(*make(), near);
  const auto solver = make();
  solution(*solver, bar.matrix);
  solver->begin_search();
  EXPECT_EQ(solution(*solver, near), fresh) << "another search";
  solution(*solver, bar.matrix);
  solver->release();
  EXPECT_EQ(solution(*solver, near), fresh) << "released";
}

TEST(MatrixSample, SeesRotationsThatLeaveTheDiagonalAsItIs) {
  BarProblem bar = make_bar_problem({.cells_per_height = 3});
  MatrixSample sample;
  EXPECT_FALSE(sample.is_near(bar.matrix, 1)) << "nothing was taken";
  sample.take(bar.matrix);
  EXPECT_TRUE(sample.is_near(bar.matrix, 0));
  const Index node = bar.matrix.num_nodes() / 2;
  const Offset beside = bar.matrix.pattern->row_begin[static_cast<std::size_t>(node)] + 1;
  const double diagonal = bar.matrix.block(beside - 1)[0];
  bar.matrix.block(beside)[1] += 0.2 * diagonal;
  EXPECT_FALSE(sample.is_near(bar.matrix, 0.1));
  EXPECT_TRUE(sample.is_near(bar.matrix, 0.5));
  sample.forget();
  EXPECT_FALSE(sample.is_near(bar.matrix, 1));
}

}  // namespace
}  // namespace resilin
