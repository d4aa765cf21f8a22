// The catalogue of linear solvers takes those of other libraries, too.

#include <gtest/gtest.h>

#include <algorithm>
#include <stdexcept>

#include "resilin/core/error.hpp"
#include "resilin/linear/linear_solver.hpp"

namespace resilin {
namespace {

/// Solves with the diagonal alone.
class DiagonalSolver final : public LinearSolver {
 public:
  std::string_view name() const override { return "diagonal"; }
  bool is_direct() const override { return true; }
  void analyze(const BlockMatrix&, const VectorX&) override {}
  LinearReport factorize(const BlockMatrix&) override { return {}; }
  LinearReport solve(const BlockMatrix&, const VectorX& b, VectorX& x, double) override {
    x = b;
    return {};
  }
};

std::unique_ptr<LinearSolver> make_diagonal(const LinearOptions&) {
  return std::make_unique<DiagonalSolver>();
}

TEST(LinearSolverCatalog, TakesASolverFromOutside) {
  EXPECT_THROW(make_linear_solver({.kind = "diagonal"}, 10), InputError);
  register_linear_solver({"diagonal", make_diagonal});
  EXPECT_EQ(make_linear_solver({.kind = "diagonal"}, 10)->name(), "diagonal");
  EXPECT_EQ(linear_solver_names().back(), "diagonal");
  EXPECT_NO_THROW(require_linear_solver("diagonal", "solver.kind"));
  // It does not say that it takes indefinite matrices.
  EXPECT_THROW(make_linear_solver({.kind = "diagonal", .is_definite = false}, 10), InputError);
}

TEST(LinearSolverCatalog, RefusesASecondSolverOfOneName) {
  for (const std::string name : {"ldlt", "auto"})
    EXPECT_THROW(register_linear_solver({name, make_diagonal}), std::invalid_argument) << name;
  EXPECT_THROW(register_linear_solver({"nothing", nullptr}), std::invalid_argument);
  EXPECT_EQ(std::ranges::count(linear_solver_names(), "ldlt"), 1);
}

}  // namespace
}  // namespace resilin
