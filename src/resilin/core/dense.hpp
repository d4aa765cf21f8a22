#pragma once

#include "resilin/core/types.hpp"

/// Products and decompositions of dense matrices of any size, by Eigen. They are compiled here and nowhere
/// else: written out in a source of its own each of them takes the compiler seconds.
namespace resilin::dense {

using Matrix = Eigen::MatrixXd;

Matrix product(const Matrix& A, const Matrix& B);             ///< A B
Matrix transposed_product(const Matrix& A, const Matrix& B);  ///< A^T B

struct Eigenpairs {
  VectorX values;  ///< rising
  Matrix vectors;  ///< by columns
  bool is_converged = true;
};

/// A x = lambda x for a symmetric A, of which the lower triangle is read; x^T x = 1.
Eigenpairs symmetric_eigenpairs(const Matrix& A);
VectorX symmetric_eigenvalues(const Matrix& A);

struct Eigenpairs3 {
  Vector3 values;              ///< rising
  resilin::Matrix<3> vectors;  ///< by columns
};
/// The same for three rows and columns, without memory of its own.
Eigenpairs3 symmetric_eigenpairs3(const resilin::Matrix<3>& A);

/// Of the symmetric tridiagonal matrix with this diagonal and these numbers below it.
Eigenpairs tridiagonal_eigenpairs(const VectorX& diagonal, const VectorX& below);
/// A x = lambda B x for a positive definite B; x^T B x = 1.
Eigenpairs generalized_eigenpairs(const Matrix& A, const Matrix& B);

/// A^-1 b by elimination with full pivoting.
VectorX solve(const Matrix& A, const VectorX& b);
Matrix inverse(const Matrix& A);

/// The X of least |A X - B|, by columns; of several the one that leaves dependent columns of A alone.
/// Householder reflections, columns by their lengths.
Matrix least_squares(const Matrix& A, const Matrix& B);
/// How many columns of A are independent: pivots of the same reflections above this part of the largest.
Eigen::Index rank(const Matrix& A, double least_pivot);

/// L with A = L L^T in the lower triangle; false when A is not positive definite.
bool cholesky(const Matrix& A, Matrix& L);
/// x = A^-1 x from L.
void solve_cholesky(const Matrix& L, VectorX& x);

}  // namespace resilin::dense
