#pragma once

#include <vector>

#include "resilin/core/types.hpp"

/// Products and decompositions of dense matrices of any size, by Eigen. They are compiled here and nowhere
/// else: written out in a source of its own each of them takes the compiler seconds.
namespace resilin::dense {

/// Dense matrix of any size, column by column.
using Matrix = Eigen::MatrixXd;

/// Products; the inner sizes must agree.
Matrix product(const Matrix& A, const Matrix& B);             ///< A B
Matrix transposed_product(const Matrix& A, const Matrix& B);  ///< A^T B

/// Eigenvalues and eigenvectors of a symmetric matrix or pair of matrices.
struct Eigenpairs {
  VectorX values;  ///< rising
  Matrix vectors;  ///< by columns
  bool is_converged = true;
};

/// A x = lambda x for a symmetric A, of which the lower triangle is read; x^T x = 1.
Eigenpairs symmetric_eigenpairs(const Matrix& A);
VectorX symmetric_eigenvalues(const Matrix& A);

/// Eigenvalues and eigenvectors of a symmetric 3 x 3 matrix.
struct Eigenpairs3 {
  Vector3 values;              ///< rising
  resilin::Matrix<3> vectors;  ///< by columns
};
/// The same for three rows and columns, without memory of its own.
Eigenpairs3 symmetric_eigenpairs3(const resilin::Matrix<3>& A);

/// Eigenpairs of the symmetric tridiagonal matrix with this diagonal and these numbers below it.
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

/// A = Q R with an orthogonal Q, which is kept as the reflections that it consists of.
struct Reflections {
  Matrix packed;         ///< R in the upper triangle, the reflections below it
  VectorX coefficients;  ///< one for each reflection
  std::vector<int>
      order;  ///< order of the columns by their lengths, or empty: A.col(order[i]) = (Q R).col(i)
};

/// Householder QR without and with an exchange of columns.
Reflections reflections(const Matrix& A);
Reflections pivoted_reflections(const Matrix& A);

/// The R with as many rows as A has columns. \pre A has as many rows
Matrix upper_triangle(const Reflections& factors);
Matrix times(const Reflections& factors, const Matrix& X);             ///< Q X
Matrix transposed_times(const Reflections& factors, const Matrix& X);  ///< Q^T X

/// Singular values and right singular vectors.
struct SingularValues {
  VectorX values;  ///< falling
  Matrix right;    ///< by columns
};
/// Decomposes A = U diag(values) right^T. By Jacobi rotations, so that small ones have their digits, too.
SingularValues singular_values(const Matrix& A);

/// R^-1 X and R^-T X for an upper triangle.
Matrix solve_upper(const Matrix& R, const Matrix& X);
Matrix solve_upper_transposed(const Matrix& R, const Matrix& X);

/// L with A = L L^T in the lower triangle; false when A is not positive definite.
bool cholesky(const Matrix& A, Matrix& L);
/// x = A^-1 x from L.
void solve_cholesky(const Matrix& L, VectorX& x);
Matrix solve_lower(const Matrix& L, const Matrix& X);  ///< L^-1 X

}  // namespace resilin::dense
