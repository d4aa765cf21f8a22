// The catalogue of linear solvers takes those of other libraries, too.

#include <gtest/gtest.h>

#include <algorithm>
#include <stdexcept>

#include "resilin/core/error.hpp"
#include "resilin/linear/linear_solver.hpp"

namespace resilin {
namespace {

/// Stands for the solver of another library; right, since other tests walk the catalogue after this one.
std::unique_ptr<LinearSolver> make_borrowed(const LinearOptions&) {
  return make_linear_solver({.kind = "ldlt"}, 10);
}

TEST(LinearSolverCatalog, TakesASolverFromOutside) {
  EXPECT_THROW(make_linear_solver({.kind = "borrowed"}, 10), InputError);
  register_linear_solver({"borrowed", make_borrowed});
  EXPECT_NE(make_linear_solver({.kind = "borrowed"}, 10), nullptr);
  EXPECT_EQ(linear_solver_names().back(), "borrowed");
  EXPECT_NO_THROW(require_linear_solver("borrowed", "solver.kind"));
  // It does not say that it takes indefinite matrices.
  EXPECT_THROW(make_linear_solver({.kind = "borrowed", .is_definite = false}, 10), InputError);
}

TEST(LinearSolverCatalog, RefusesASecondSolverOfOneName) {
  for (const std::string name : {"ldlt", "auto"})
    EXPECT_THROW(register_linear_solver({name, make_borrowed}), std::invalid_argument) << name;
  EXPECT_THROW(register_linear_solver({"nothing", nullptr}), std::invalid_argument);
  EXPECT_EQ(std::ranges::count(linear_solver_names(), "ldlt"), 1);
}

}  // namespace
}  // namespace resilin
