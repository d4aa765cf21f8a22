#include "resilin/linear/direct_solver.hpp"

#include <algorithm>

namespace resilin {

LinearReport DirectSolver::solve(const BlockMatrix& A, const VectorX& b, VectorX& x,
                                 double relative_tolerance) {
  constexpr int max_refinements = 2;
  constexpr double round_off = 1e-8;
  LinearReport report;
  const double b_norm = b.norm();
  if (b_norm == 0) {
    x.setZero(b.size());
    return report;
  }
  solve_factored(b, x);
  for (int refinement = 0;; ++refinement) {
    multiply(A, x, residual_, work_);
    residual_ = b - residual_;
    report.relative_residual = residual_.norm() / b_norm;
    if (report.relative_residual <= relative_tolerance || refinement == max_refinements) break;
    solve_factored(residual_, correction_);
    x += correction_;
  }
  if (!(report.relative_residual <= std::max(relative_tolerance, round_off)))
    report.status = LinearReport::Status::not_converged;
  return report;
}

}  // namespace resilin
