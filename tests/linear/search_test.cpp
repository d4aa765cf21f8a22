// A search for an equilibrium gives the same bits whatever was solved before it, pairs that touched included.

#include <gtest/gtest.h>

#include "bar_problem.hpp"
#include "resilin/linear/linear_solver.hpp"

namespace resilin {
namespace {

using Springs = std::vector<std::pair<Index, Index>>;

struct EverySearch : ::testing::TestWithParam<std::string> {
  const BarProblem bar = make_bar_problem({.cells_per_height = 4, .poissons_ratio = 0.4});

  std::unique_ptr<LinearSolver> make() const {
    return make_linear_solver({.kind = GetParam()}, bar.matrix.num_unknowns());
  }
  /// The bar with springs between nodes that are no neighbours.
  BlockMatrix touching(const Springs& pairs) const {
    BlockMatrix A = bar.matrix;
    const Eigen::Matrix3d spring = 1e5 * Eigen::Matrix3d::Identity(), minus = -spring;
    for (const auto& [i, j] : pairs) {
      A.add_block(i, i, spring.data());
      A.add_block(j, j, spring.data());
      A.add_block(i, j, minus.data());
    }
    return A;
  }
  VectorX solution(LinearSolver& solver, const BlockMatrix& A) const {
    solver.analyze(A, bar.node_positions);
    EXPECT_EQ(solver.factorize(A).status, LinearReport::Status::ok);
    VectorX x = VectorX::Zero(bar.right_side.size());
    EXPECT_EQ(solver.solve(A, bar.right_side, x, 1e-9).status, LinearReport::Status::ok);
    return x;
  }
};
INSTANTIATE_TEST_SUITE_P(LinearSolver, EverySearch, ::testing::ValuesIn(linear_solver_names()),
                         [](const auto& entry) { return entry.param; });

TEST_P(EverySearch, HasTheSameBitsWhateverWentBeforeIt) {
  const Index last = bar.matrix.num_nodes() - 1;
  const BlockMatrix some = touching({{last, 3}, {last - 7, last / 3}});
  const VectorX expected = solution(*make(), some);
  const auto solver = make();
  solution(*solver,
           touching({{last, 3}, {last - 7, last / 3}, {last / 2, 1}, {last - 20, 10}, {last - 1, 5}}));
  solver->begin_search();
  EXPECT_EQ(solution(*solver, some), expected);
}

}  // namespace
}  // namespace resilin
