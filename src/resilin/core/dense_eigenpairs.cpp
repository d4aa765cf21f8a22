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

Eigenpairs3 symmetric_eigenpairs3(const resilin::Matrix<3>& A) {
  const Eigen::SelfAdjointEigenSolver<resilin::Matrix<3>> solver(A);
  return {solver.eigenvalues(), solver.eigenvectors()};
}

Eigenpairs tridiagonal_eigenpairs(const VectorX& diagonal, const VectorX& below) {
  Solver solver;
  solver.computeFromTridiagonal(diagonal, below);
  return pairs_of(solver);
}

Eigenpairs generalized_eigenpairs(const Matrix& A, const Matrix& B) {
  return pairs_of(Eigen::GeneralizedSelfAdjointEigenSolver<Matrix>(A, B));
}

}  // namespace resilin::dense
