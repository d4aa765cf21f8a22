#include "resilin/core/dense.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <Eigen/QR>

namespace resilin::dense {

Matrix product(const Matrix& A, const Matrix& B) { return A * B; }

Matrix transposed_product(const Matrix& A, const Matrix& B) { return A.transpose() * B; }

VectorX solve(const Matrix& A, const VectorX& b) { return A.fullPivLu().solve(b); }

Matrix inverse(const Matrix& A) { return A.inverse(); }

Matrix least_squares(const Matrix& A, const Matrix& B) { return A.colPivHouseholderQr().solve(B); }

Eigen::Index rank(const Matrix& A, double least_pivot) {
  Eigen::ColPivHouseholderQR<Matrix> factors;
  factors.setThreshold(least_pivot);
  return factors.compute(A).rank();
}

bool cholesky(const Matrix& A, Matrix& L) {
  const Eigen::LLT<Matrix> factorisation(A);
  L = factorisation.matrixLLT();
  return factorisation.info() == Eigen::Success;
}

void solve_cholesky(const Matrix& L, VectorX& x) {
  L.triangularView<Eigen::Lower>().solveInPlace(x);
  L.adjoint().triangularView<Eigen::Upper>().solveInPlace(x);
}

}  // namespace resilin::dense
