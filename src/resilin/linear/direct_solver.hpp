#pragma once

#include <vector>

#include "resilin/linear/linear_solver.hpp"

namespace resilin {

/// What direct solvers share: the residual of every solve is checked, and refined when it misses the
/// tolerance.
class DirectSolver : public LinearSolver {
 public:
  bool is_direct() const override { return true; }

  /// `not_converged` when the residual stays above the tolerance and above 1e-8: the factors do not belong to
  /// A, or A is singular to working precision.
  LinearReport solve(const BlockMatrix& A, const VectorX& b, VectorX& x, double relative_tolerance) override;

 protected:
  /// x = (factors)^-1 b.
  virtual void solve_factored(const VectorX& b, VectorX& x) = 0;

 private:
  VectorX residual_, correction_;
  std::vector<double> work_;
};

}  // namespace resilin
