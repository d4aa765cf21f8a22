#include "resilin/core/dense.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <Eigen/QR>
#include <Eigen/SVD>

namespace resilin::dense {

Matrix product(const Matrix& A, const Matrix& B) { return A * B; }

Matrix transposed_product(const Matrix& A, const Matrix& B) { return A.transpose() * B; }

VectorX solve(const Matrix& A, const VectorX& b) { return A.fullPivLu().solve(b); }

Matrix inverse(const Matrix& A) { return A.inverse(); }

// Eigen seeks the longest of no columns where there are none: it reads what is not there.
Matrix least_squares(const Matrix& A, const Matrix& B) {
  if (A.cols() == 0) return Matrix::Zero(0, B.cols());
  return A.colPivHouseholderQr().solve(B);
}

Eigen::Index rank(const Matrix& A, double least_pivot) {
  if (A.cols() == 0) return 0;
  Eigen::ColPivHouseholderQR<Matrix> factors;
  factors.setThreshold(least_pivot);
  return factors.compute(A).rank();
}

namespace {

auto sequence_of(const Reflections& factors) {
  return Eigen::HouseholderSequence<Matrix, VectorX>(factors.packed, factors.coefficients)
      .setLength(factors.coefficients.size());
}

}  // namespace

Reflections reflections(const Matrix& A) {
  const Eigen::HouseholderQR<Matrix> factors(A);
  return {factors.matrixQR(), factors.hCoeffs(), {}};
}

Reflections pivoted_reflections(const Matrix& A) {
  if (A.cols() == 0) return {A, VectorX(), {}};
  const Eigen::ColPivHouseholderQR<Matrix> factors(A);
  const auto& order = factors.colsPermutation().indices();
  return {factors.matrixQR(), factors.hCoeffs(), {order.begin(), order.end()}};
}

Matrix upper_triangle(const Reflections& factors) {
  return factors.packed.topRows(factors.packed.cols()).triangularView<Eigen::Upper>();
}

Matrix times(const Reflections& factors, const Matrix& X) {
  Matrix product = X;
  product.applyOnTheLeft(sequence_of(factors));
  return product;
}

Matrix transposed_times(const Reflections& factors, const Matrix& X) {
  Matrix product = X;
  product.applyOnTheLeft(sequence_of(factors).transpose());
  return product;
}

SingularValues singular_values(const Matrix& A) {
  const Eigen::JacobiSVD<Matrix> svd(A, Eigen::ComputeThinU | Eigen::ComputeThinV);
  return {svd.singularValues(), svd.matrixV()};
}

Matrix solve_upper(const Matrix& R, const Matrix& X) { return R.triangularView<Eigen::Upper>().solve(X); }

Matrix solve_upper_transposed(const Matrix& R, const Matrix& X) {
  return R.transpose().triangularView<Eigen::Lower>().solve(X);
}

Matrix solve_lower(const Matrix& L, const Matrix& X) { return L.triangularView<Eigen::Lower>().solve(X); }

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
