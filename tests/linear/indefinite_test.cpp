// Solvers for symmetric matrices that need not be definite: they solve, and count the negative eigenvalues.

#include <gtest/gtest.h>

#include "bar_problem.hpp"
#include "resilin/core/error.hpp"
#include "resilin/core/parallel.hpp"
#include "resilin/linear/linear_solver.hpp"
#include "sample_matrix.hpp"

namespace resilin {
namespace {

using testing::dense;
using Status = LinearReport::Status;

struct IndefiniteSolver : ::testing::TestWithParam<std::tuple<std::string, int>> {
  const std::string kind = std::get<0>(GetParam());
  const int dim = std::get<1>(GetParam());

  std::unique_ptr<LinearSolver> make() const {
    return make_linear_solver({.kind = kind, .is_definite = false}, 100);
  }
  /// The stiffness of a bar less `shift` times its largest diagonal entry times the identity.
  BarProblem shifted_bar(double shift) const {
    BarProblem bar = make_bar_problem({.dim = dim, .cells_per_height = dim == 3 ? 3 : 8});
    double largest = 0;
    for (Index i = 0; i < bar.matrix.num_nodes(); ++i)
      largest = std::max(largest, bar.matrix.block(bar.matrix.pattern->slot(i, i))[0]);
    for (Index i = 0; i < bar.matrix.num_nodes(); ++i)
      for (int d = 0; d < dim; ++d) bar.matrix.add_to_diagonal(i, d, -shift * largest);
    return bar;
  }
};

/// Those of the catalogue that say so.
std::vector<std::string> names_of_solvers() {
  std::vector<std::string> names = {"auto"};
  for (const std::string& name : linear_solver_names()) {
    try {
      make_linear_solver({.kind = name, .is_definite = false}, 100);
      names.push_back(name);
    } catch (const InputError&) {
    }
  }
  return names;
}

INSTANTIATE_TEST_SUITE_P(LinearSolver, IndefiniteSolver,
                         ::testing::Combine(::testing::ValuesIn(names_of_solvers()), ::testing::Values(2, 3)),
                         [](const auto& parameters) {
                           return std::get<0>(parameters.param) + "_" +
                                  std::to_string(std::get<1>(parameters.param)) + "d";
                         });

TEST_P(IndefiniteSolver, CountsTheNegativeEigenvaluesAndSolves) {
  const auto solver = make();
  Index most = 0;
  for (const double shift : {0.0, 1e-3, 0.02, 0.3, 0.9, 3.0}) {
    const BarProblem bar = shifted_bar(shift);
    const Eigen::VectorXd eigenvalues =
        Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(dense(bar.matrix), Eigen::EigenvaluesOnly)
            .eigenvalues();
    const LinearReport report = solver->factorize(bar.matrix);
    ASSERT_EQ(report.status, Status::ok) << shift;
    EXPECT_EQ(report.negative_pivots, (eigenvalues.array() < 0).count()) << shift;
    most = std::max(most, report.negative_pivots);
    VectorX x;
    EXPECT_EQ(solver->solve(bar.matrix, bar.right_side, x, 1e-9).status, Status::ok) << shift;
    VectorX Ax;
    multiply(bar.matrix, x, Ax);
    EXPECT_LT((bar.right_side - Ax).norm(), 1.1e-9 * bar.right_side.norm()) << shift;
  }
  EXPECT_GT(most, 100) << "the shifts are too small to try whole fronts of negative pivots";
}

TEST_P(IndefiniteSolver, GivesTheSameBitsForAnyNumberOfThreads) {
  const BarProblem bar = shifted_bar(0.02);
  const int threads_before = num_threads();
  VectorX x[2];
  Index negative[2];
  for (const int threads : {1, 2}) {
    set_num_threads(threads);
    const auto solver = make();
    negative[threads - 1] = solver->factorize(bar.matrix).negative_pivots;
    solver->solve(bar.matrix, bar.right_side, x[threads - 1], 1e-6);
  }
  set_num_threads(threads_before);
  EXPECT_EQ(x[0], x[1]);
  EXPECT_EQ(negative[0], negative[1]);
}

TEST_P(IndefiniteSolver, RefusesASingularMatrix) {
  BarProblem bar = shifted_bar(0);
  bar.matrix.set_zero();
  const LinearReport report = make()->factorize(bar.matrix);
  EXPECT_EQ(report.status, Status::indefinite);
  EXPECT_GE(report.worst_node, 0);
}

TEST(LinearSolver, WithoutSignsIsRefusedWhereTheMatrixNeedNotBeDefinite) {
  EXPECT_THROW(make_linear_solver({.kind = "cg_amg", .is_definite = false}, 100), InputError);
}

}  // namespace
}  // namespace resilin
