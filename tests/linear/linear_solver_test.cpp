#include "resilin/linear/linear_solver.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "bar_problem.hpp"
#include "resilin/core/error.hpp"
#include "resilin/core/parallel.hpp"
#include "resilin/linear/blas.hpp"
#include "sample_matrix.hpp"
#include "solver_benchmark.hpp"

namespace resilin {
namespace {

using testing::dense;
using testing::sample_matrix;
using Status = LinearReport::Status;

/// Properties that every solver in the catalogue must have, in 2D and in 3D.
struct EverySolver : ::testing::TestWithParam<std::tuple<std::string, int>> {
  const std::string kind = std::get<0>(GetParam());
  const int dim = std::get<1>(GetParam());

  std::unique_ptr<LinearSolver> make(const BlockMatrix& A) const {
    return make_linear_solver({.kind = kind}, A.num_unknowns());
  }
  BarProblem bar(double poissons_ratio = 0.4) const {
    return make_bar_problem(
        {.dim = dim, .cells_per_height = dim == 3 ? 4 : 12, .poissons_ratio = poissons_ratio});
  }
};

std::vector<std::string> all_names() {
  std::vector<std::string> names = linear_solver_names();
  names.emplace_back("auto");
  return names;
}

INSTANTIATE_TEST_SUITE_P(LinearSolver, EverySolver,
                         ::testing::Combine(::testing::ValuesIn(all_names()), ::testing::Values(2, 3)),
                         [](const auto& parameters) {
                           return std::get<0>(parameters.param) + "_" +
                                  std::to_string(std::get<1>(parameters.param)) + "d";
                         });

double relative_residual(const BlockMatrix& A, const VectorX& b, const VectorX& x) {
  VectorX Ax;
  multiply(A, x, Ax);
  return (b - Ax).norm() / b.norm();
}

TEST_P(EverySolver, ReachesTheToleranceAskedFor) {
  const BarProblem problem = bar();
  const auto solver = make(problem.matrix);
  solver->analyze(problem.matrix, problem.node_positions);
  ASSERT_EQ(solver->factorize(problem.matrix).status, Status::ok);
  VectorX x = VectorX::Zero(problem.right_side.size());
  const LinearReport report = solver->solve(problem.matrix, problem.right_side, x, 1e-9);
  EXPECT_EQ(report.status, Status::ok);
  EXPECT_LE(report.relative_residual, 1e-9);
  EXPECT_LT(relative_residual(problem.matrix, problem.right_side, x),
            1.1e-9);  // the iterated one drifts a little
  for (Eigen::Index k = 0; k < x.size(); ++k)
    EXPECT_EQ(problem.is_fixed[static_cast<std::size_t>(k)] != 0 ? x[k] : 0, 0);
}

TEST_P(EverySolver, SolvesNewValuesOnTheSamePattern) {
  BarProblem problem = bar();
  const auto solver = make(problem.matrix);
  solver->analyze(problem.matrix, problem.node_positions);
  solver->factorize(problem.matrix);
  VectorX x;
  solver->solve(problem.matrix, problem.right_side, x, 1e-9);
  problem.matrix = bar(0.2).matrix;  // an equal pattern, but not the same one
  for (const double factor : {1.0, 3.0}) {
    for (double& value : problem.matrix.values) value *= factor;
    ASSERT_EQ(solver->factorize(problem.matrix).status, Status::ok);
    x.setZero();
    EXPECT_EQ(solver->solve(problem.matrix, problem.right_side, x, 1e-9).status, Status::ok);
    EXPECT_LT(relative_residual(problem.matrix, problem.right_side, x), 1.1e-9);
  }
}

TEST_P(EverySolver, AnalysesAPatternBeforeItsValuesAreKnown) {
  const BarProblem problem = bar();
  BlockMatrix empty = problem.matrix;
  empty.set_zero();
  const auto solver = make(empty);
  solver->analyze(empty, problem.node_positions);
  ASSERT_EQ(solver->factorize(problem.matrix).status, Status::ok);
  VectorX x;
  EXPECT_EQ(solver->solve(problem.matrix, problem.right_side, x, 1e-9).status, Status::ok);
}

TEST_P(EverySolver, NeedsNoPositions) {
  const BarProblem problem = bar();
  const auto solver = make(problem.matrix);
  solver->analyze(problem.matrix, {});
  ASSERT_EQ(solver->factorize(problem.matrix).status, Status::ok);
  VectorX x;
  EXPECT_EQ(solver->solve(problem.matrix, problem.right_side, x, 1e-9).status, Status::ok);
}

TEST_P(EverySolver, HonoursExtraBlocksThatComeAndGo) {
  BarProblem problem = bar();
  const auto solver = make(problem.matrix);
  solver->analyze(problem.matrix, problem.node_positions);
  const Index last = problem.matrix.num_nodes() - 1;
  const BlockMatrix base = problem.matrix;
  // Springs k (1, -1; -1, 1) between far nodes keep the matrix definite.
  for (const std::vector<std::pair<Index, Index>>& pairs :
       {std::vector<std::pair<Index, Index>>{{last, last / 2}, {last - 3, last / 3}},
        {{last, last / 2}},
        {},
        {{last / 4, last}}}) {
    problem.matrix = base;
    Eigen::Matrix<double, -1, -1, Eigen::RowMajor> spring = 1e5 * Eigen::MatrixXd::Identity(dim, dim);
    spring.topRightCorner(1, 1).setConstant(2e4);
    spring.bottomLeftCorner(1, 1).setConstant(2e4);
    const Eigen::Matrix<double, -1, -1, Eigen::RowMajor> minus = -spring;
    for (const auto& [i, j] : pairs) {
      problem.matrix.add_block(i, i, spring.data());
      problem.matrix.add_block(j, j, spring.data());
      problem.matrix.add_block(i, j, minus.data());
    }
    ASSERT_EQ(problem.matrix.extra.size(), pairs.size());
    ASSERT_EQ(solver->factorize(problem.matrix).status, Status::ok);
    VectorX x;
    EXPECT_EQ(solver->solve(problem.matrix, problem.right_side, x, 1e-9).status, Status::ok);
    EXPECT_LT(relative_residual(problem.matrix, problem.right_side, x), 1.1e-9);
  }
}

TEST_P(EverySolver, ReportsAnIndefiniteMatrix) {
  BarProblem problem = bar();
  const Index bad_node = problem.matrix.num_nodes() / 2;
  // Softer than the neighbours hold: the diagonal block stays definite, the matrix does not.
  double* diagonal = problem.matrix.block(problem.matrix.pattern->slot(bad_node, bad_node));
  for (int d = 0; d < dim; ++d) diagonal[d * (dim + 1)] *= 0.5;
  ASSERT_NE(dense(problem.matrix).llt().info(), Eigen::Success);
  const auto solver = make(problem.matrix);
  solver->analyze(problem.matrix, problem.node_positions);
  LinearReport report = solver->factorize(problem.matrix);
  if (report.status == Status::ok) {
    VectorX x = VectorX::Zero(problem.right_side.size());
    report = solver->solve(problem.matrix, problem.right_side, x, 1e-9);
    EXPECT_GT(problem.right_side.dot(x), 0) << "the last iterate is no direction of descent";
  }
  EXPECT_EQ(report.status, Status::indefinite);
  EXPECT_GE(report.worst_node, 0);
}

TEST_P(EverySolver, NamesTheNodeWhoseDiagonalIsNegative) {
  BarProblem problem = bar();
  const Index bad_node = problem.matrix.num_nodes() / 2;
  problem.matrix.add_to_diagonal(bad_node, dim - 1, -1e8);
  const auto solver = make(problem.matrix);
  solver->analyze(problem.matrix, problem.node_positions);
  const LinearReport report = solver->factorize(problem.matrix);
  if (report.status == Status::ok) GTEST_SKIP() << "seen by the iteration only";
  EXPECT_EQ(report.status, Status::indefinite);
  EXPECT_EQ(report.worst_node, bad_node);
}

TEST_P(EverySolver, NeitherHangsNorSaysOkWhenANumberIsNone) {
  for (const bool is_diagonal : {true, false}) {
    BarProblem problem = bar();
    const Index node = problem.matrix.num_nodes() / 2;
    const Offset diagonal = problem.matrix.pattern->slot(node, node);
    problem.matrix.block(is_diagonal ? diagonal : diagonal + 1)[1] = std::numeric_limits<double>::quiet_NaN();
    if (is_diagonal) problem.matrix.block(diagonal)[dim] = std::numeric_limits<double>::quiet_NaN();
    const auto solver = make(problem.matrix);
    solver->analyze(problem.matrix, problem.node_positions);
    LinearReport report = solver->factorize(problem.matrix);
    VectorX x;
    if (report.status == Status::ok) report = solver->solve(problem.matrix, problem.right_side, x, 1e-9);
    EXPECT_NE(report.status, Status::ok);
  }
}

TEST_P(EverySolver, GivesTheSameBitsForAnyNumberOfThreads) {
  const BarProblem problem = bar();
  const int threads_before = num_threads();
  VectorX x[2];
  for (const int threads : {1, 2}) {
    set_num_threads(threads);
    const auto solver = make(problem.matrix);
    solver->analyze(problem.matrix, problem.node_positions);
    solver->factorize(problem.matrix);
    solver->solve(problem.matrix, problem.right_side, x[threads - 1], 1e-6);
  }
  set_num_threads(threads_before);
  EXPECT_EQ(x[0], x[1]);
}

TEST_P(EverySolver, NamesTheSameNodeForAnyNumberOfThreads) {
  BarProblem problem = bar();
  for (const Index node : {problem.matrix.num_nodes() / 3, problem.matrix.num_nodes() / 2})
    for (int d = 0; d < dim; ++d)
      problem.matrix.block(problem.matrix.pattern->slot(node, node))[d * (dim + 1)] *= 0.5;
  const int threads_before = num_threads();
  LinearReport reports[2];
  for (const int threads : {1, 2}) {
    set_num_threads(threads);
    const auto solver = make(problem.matrix);
    LinearReport& report = reports[threads - 1];
    report = solver->factorize(problem.matrix);
    VectorX x;
    if (report.status == Status::ok) report = solver->solve(problem.matrix, problem.right_side, x, 1e-9);
  }
  set_num_threads(threads_before);
  EXPECT_EQ(reports[0].status, Status::indefinite);
  EXPECT_EQ(reports[1].status, Status::indefinite);
  EXPECT_EQ(reports[0].worst_node, reports[1].worst_node);
}

TEST_P(EverySolver, RepeatsItsBitsWhenUsedAgain) {
  const BarProblem problem = bar(), other = bar(0.1);
  const auto solver = make(problem.matrix);
  VectorX x[2];
  for (VectorX& solution : x) {
    solver->factorize(other.matrix);
    solver->factorize(problem.matrix);
    solver->solve(problem.matrix, problem.right_side, solution, 1e-6);
  }
  EXPECT_EQ(x[0], x[1]);
}

TEST_P(EverySolver, RepeatsItsBitsAfterGivingBackItsMemory) {
  const BarProblem problem = bar();
  const auto solver = make(problem.matrix);
  VectorX solutions[2];
  for (VectorX& x : solutions) {
    solver->analyze(problem.matrix, problem.node_positions);
    ASSERT_EQ(solver->factorize(problem.matrix).status, Status::ok);
    x.setZero(problem.right_side.size());
    solver->solve(problem.matrix, problem.right_side, x, 1e-9);
    solver->release();
  }
  EXPECT_EQ(solutions[0], solutions[1]);
  EXPECT_LT(relative_residual(problem.matrix, problem.right_side, solutions[0]), 1e-8);
}

TEST_P(EverySolver, SolvesAnUnstructuredMatrixWithUnlikeBlocks) {
  const BlockMatrix A = sample_matrix(dim, 200, 25, 10);
  const auto solver = make(A);
  solver->analyze(A, {});
  ASSERT_EQ(solver->factorize(A).status, Status::ok);
  const VectorX b = VectorX::Random(A.num_unknowns());
  VectorX x;
  EXPECT_EQ(solver->solve(A, b, x, 1e-10).status, Status::ok);
  const VectorX expected = dense(A).ldlt().solve(b);
  EXPECT_LT((x - expected).norm(), 1e-8 * expected.norm());  // condition about 10
}

TEST_P(EverySolver, GivesZeroForAZeroRightSide) {
  const BarProblem problem = bar();
  const auto solver = make(problem.matrix);
  solver->factorize(problem.matrix);
  VectorX x = VectorX::Zero(problem.right_side.size());
  EXPECT_EQ(solver->solve(problem.matrix, VectorX::Zero(x.size()), x, 1e-9).status, Status::ok);
  EXPECT_EQ(x.norm(), 0);
}

TEST(LinearSolver, ThatDoesNotExistIsRefusedWithTheNearestName) {
  try {
    make_linear_solver({.kind = "choleski"}, 10);
    FAIL() << "no error";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("cholesky"), std::string::npos) << error.what();
  }
}

TEST(LinearSolver, StopsAtTheLargestNumberOfIterations) {
  const BarProblem problem = make_bar_problem({});
  const auto solver = make_linear_solver({.kind = "cg_jacobi", .max_iterations = 5}, 100);
  solver->factorize(problem.matrix);
  VectorX x;
  const LinearReport report = solver->solve(problem.matrix, problem.right_side, x, 1e-9);
  EXPECT_EQ(report.status, Status::not_converged);
  EXPECT_EQ(report.iterations, 5);
  EXPECT_GT(problem.right_side.dot(x), 0);
}

/// The mesh refined three times: Jacobi's iterations grow like 1/h, those of the multigrid stay.
TEST(MultigridSolver, NeedsAboutTheSameIterationsOnEveryMesh) {
  for (const int dim : {2, 3}) {
    std::vector<int> iterations;
    for (const int n : dim == 2 ? std::vector<int>{8, 16, 32, 64} : std::vector<int>{3, 5, 8, 12}) {
      const BarProblem bar = make_bar_problem({.dim = dim, .cells_per_height = n, .poissons_ratio = 0.3});
      const auto solver = make_linear_solver({.kind = "cg_amg"}, bar.matrix.num_unknowns());
      solver->analyze(bar.matrix, bar.node_positions);
      ASSERT_EQ(solver->factorize(bar.matrix).status, Status::ok);
      VectorX x;
      const LinearReport report = solver->solve(bar.matrix, bar.right_side, x, 1e-8);
      ASSERT_EQ(report.status, Status::ok);
      iterations.push_back(report.iterations);
    }
    EXPECT_LE(iterations.back(), 2 * iterations.front()) << "dim " << dim;
    EXPECT_LE(iterations.back(), 40) << "dim " << dim;
  }
}

TEST(MultigridSolver, GainsFromThePositions) {
  const BarProblem bar = make_bar_problem({.cells_per_height = 8});
  int iterations[2];
  for (const bool is_told : {false, true}) {
    const auto solver = make_linear_solver({.kind = "cg_amg"}, bar.matrix.num_unknowns());
    solver->analyze(bar.matrix, is_told ? bar.node_positions : VectorX{});
    solver->factorize(bar.matrix);
    VectorX x;
    iterations[is_told ? 1 : 0] = solver->solve(bar.matrix, bar.right_side, x, 1e-8).iterations;
  }
  EXPECT_LT(iterations[1], 0.7 * iterations[0]);
}

/// Large rotations turn the modes with the body: rest positions are no longer right, positions are.
TEST(MultigridSolver, FollowsABodyThatHasTurned) {
  BarProblem bar = make_bar_problem({.cells_per_height = 7});
  const Eigen::Matrix3d R = Eigen::AngleAxisd(1.2, Vector3(1, 2, 3).normalized()).toRotationMatrix();
  for (Offset s = 0; s < bar.matrix.pattern->num_slots(); ++s) {
    Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> block(bar.matrix.block(s));
    block = (R * block * R.transpose()).eval();
  }
  VectorX positions = bar.node_positions;
  for (Index i = 0; i < bar.matrix.num_nodes(); ++i)
    positions.segment<3>(3 * i) = R * bar.node_positions.segment<3>(3 * i);
  const auto solver = make_linear_solver({.kind = "cg_amg"}, bar.matrix.num_unknowns());
  int iterations[2];
  for (const bool is_told : {false, true}) {
    solver->begin_search();  // within one the preconditioner of a matrix is kept
    solver->analyze(bar.matrix, is_told ? positions : bar.node_positions);
    solver->factorize(bar.matrix);
    VectorX x;
    iterations[is_told ? 1 : 0] = solver->solve(bar.matrix, bar.right_side, x, 1e-8).iterations;
  }
  EXPECT_LT(iterations[1], 0.7 * iterations[0]);
}

TEST(AutomaticSolver, FallsBackToADirectOneWhereIterationsDoNotArrive) {
  const BarProblem bar = make_bar_problem({.cells_per_height = 7, .poissons_ratio = 0.499999});
  for (const bool is_dynamic : {false, true}) {
    const auto solver =
        make_linear_solver({.kind = "auto", .is_dynamic = is_dynamic}, bar.matrix.num_unknowns());
    solver->analyze(bar.matrix, bar.node_positions);
    ASSERT_EQ(solver->factorize(bar.matrix).status, Status::ok);
    VectorX x;
    const LinearReport report = solver->solve(bar.matrix, bar.right_side, x, 1e-7);
    EXPECT_EQ(report.status, Status::ok);
    EXPECT_GE(report.iterations, 40) << "the case is too easy to show it";
    EXPECT_LT(relative_residual(bar.matrix, bar.right_side, x), 1.1e-7);
  }
}

/// As for a tangent that is not symmetric: what was saved by not factorising is soon spent.
TEST(AutomaticSolver, FactorisesWhereOneMatrixIsSolvedWithManyTimes) {
  const BarProblem bar = make_bar_problem({.cells_per_height = 7, .poissons_ratio = 0.3});
  const auto solver = make_linear_solver({.kind = "auto"}, bar.matrix.num_unknowns());
  const auto iterations_of_a_solve = [&] {
    VectorX x;
    const LinearReport report = solver->solve(bar.matrix, bar.right_side, x, 1e-8);
    EXPECT_EQ(report.status, Status::ok);
    EXPECT_LT(relative_residual(bar.matrix, bar.right_side, x), 1.1e-8);
    return report.iterations;
  };
  const auto begin = [&] {
    solver->analyze(bar.matrix, bar.node_positions);
    ASSERT_EQ(solver->factorize(bar.matrix).status, Status::ok);
  };
  begin();
  const int first = iterations_of_a_solve();
  ASSERT_GT(first, 0) << "a direct solver has been chosen from the start";
  for (int i = 0; i < 5; ++i) iterations_of_a_solve();
  EXPECT_EQ(iterations_of_a_solve(), 0);
  begin();
  EXPECT_EQ(iterations_of_a_solve(), 0) << "the next matrix of the same search";
  solver->begin_search();
  begin();
  EXPECT_EQ(iterations_of_a_solve(), first) << "another search, with the same bits as the first";
}

TEST(SolverBenchmark, TimesEverySolver) {
  const std::vector<SolverTiming> timings =
      benchmark_solvers({.bar = {.cells_per_height = 2}, .solvers = {}, .repeats = 1});
  ASSERT_EQ(timings.size(), linear_solver_names().size());
  for (const SolverTiming& timing : timings) {
    EXPECT_EQ(timing.num_unknowns, 243);
    EXPECT_EQ(timing.failure, "") << timing.solver;
    EXPECT_GT(timing.factorize + timing.solve, 0) << timing.solver;
    EXPECT_LT(timing.true_residual, 2e-8) << timing.solver;
  }
}

TEST(Blas, SaysWhichKernelItUses) { EXPECT_FALSE(blas_kernel_name().empty()); }

}  // namespace
}  // namespace resilin
