#include <Eigen/Eigenvalues>

#include "resilin/core/dense.hpp"

namespace resilin::dense {
namespace {

using Solver = Eigen::SelfAdjointEigenSolver<Matrix>;

Eigenpairs pairs_of(const Solver& solver) {
  return {solver.eigenvalues(), solver.eigenvectors(), solver.info() == Eigen::Success};
}

}  // namespace

Eigenpairs symmetric_eigenpairs(const Matrix& A) { return pairs_of(Solver(A)); }

VectorX symmetric_eigenvalues(const Matrix& A) { return Solver(A, Eigen::EigenvaluesOnly).eigenvalues(); }

Eigenpairs tridiagonal_eigenpairs(const VectorX& diagonal, const VectorX& below) {
  Solver solver;
  solver.computeFromTridiagonal(diagonal, below);
  return pairs_of(solver);
}

Eigenpairs generalized_eigenpairs(const Matrix& A, const Matrix& B) {
  return pairs_of(Eigen::GeneralizedSelfAdjointEigenSolver<Matrix>(A, B));
}

}  // namespace resilin::dense
