#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <cmath>

#include "resilin/linear/blas.hpp"

/// The routines of BLAS and LAPACK that the multifrontal solver calls, for a build without either: of their
/// options those that it uses.
namespace {

using Matrix = Eigen::MatrixXd;
using Stride = Eigen::OuterStride<>;
using ConstMap = Eigen::Map<const Matrix, 0, Stride>;
using Map = Eigen::Map<Matrix, 0, Stride>;
using StepMap = Eigen::Map<Eigen::VectorXd, 0, Eigen::InnerStride<>>;
using ConstStepMap = Eigen::Map<const Eigen::VectorXd, 0, Eigen::InnerStride<>>;

bool is(const char* option, char letter) { return *option == letter; }

/// The target may hold NaN when beta is zero.
template <class Target>
void scale(Target&& target, double beta) {
  if (beta == 0) {
    target.setZero();
  } else if (beta != 1) {
    target *= beta;
  }
}

}  // namespace

extern "C" {

/// C = alpha op(A) op(B) + beta C.
void dgemm_(const char* of_a, const char* of_b, const int* m, const int* n, const int* k, const double* alpha,
            const double* a, const int* lda, const double* b, const int* ldb, const double* beta, double* c,
            const int* ldc) {
  Map C(c, *m, *n, Stride(*ldc));
  scale(C, *beta);
  const bool transposes_a = !is(of_a, 'N'), transposes_b = !is(of_b, 'N');
  const ConstMap A(a, transposes_a ? *k : *m, transposes_a ? *m : *k, Stride(*lda));
  const ConstMap B(b, transposes_b ? *n : *k, transposes_b ? *k : *n, Stride(*ldb));
  if (transposes_a && transposes_b) {
    C.noalias() += *alpha * A.transpose() * B.transpose();
  } else if (transposes_a) {
    C.noalias() += *alpha * A.transpose() * B;
  } else if (transposes_b) {
    C.noalias() += *alpha * A * B.transpose();
  } else {
    C.noalias() += *alpha * A * B;
  }
}

/// The lower triangle of C = alpha A A^T + beta C.
void dsyrk_(const char*, const char*, const int* n, const int* k, const double* alpha, const double* a,
            const int* lda, const double* beta, double* c, const int* ldc) {
  Map C(c, *n, *n, Stride(*ldc));
  for (int column = 0; column < *n; ++column) scale(C.col(column).tail(*n - column), *beta);
  C.selfadjointView<Eigen::Lower>().rankUpdate(ConstMap(a, *n, *k, Stride(*lda)), *alpha);
}

/// B = alpha B L^-T.
void dtrsm_(const char*, const char*, const char*, const char*, const int* m, const int* n,
            const double* alpha, const double* a, const int* lda, double* b, const int* ldb) {
  Map B(b, *m, *n, Stride(*ldb));
  scale(B, *alpha);
  ConstMap(a, *n, *n, Stride(*lda))
      .transpose()
      .triangularView<Eigen::Upper>()
      .solveInPlace<Eigen::OnTheRight>(B);
}

/// A = L L^T in the lower triangle, from left to right. `info` is the first column, from 1, whose pivot is
/// not positive.
void dpotrf_(const char*, const int* n, double* a, const int* lda, int* info) {
  Map A(a, *n, *n, Stride(*lda));
  for (int column = 0; column < *n; ++column) {
    const double pivot = A(column, column) - A.row(column).head(column).squaredNorm();
    if (!(pivot > 0)) {
      *info = column + 1;
      return;
    }
    const double root = A(column, column) = std::sqrt(pivot);
    const int below = *n - column - 1;
    auto rest = A.col(column).tail(below);
    rest.noalias() -= A.block(column + 1, 0, below, column) * A.row(column).head(column).transpose();
    rest /= root;
  }
  *info = 0;
}

/// y = alpha op(A) x + beta y.
void dgemv_(const char* of_a, const int* m, const int* n, const double* alpha, const double* a,
            const int* lda, const double* x, const int* step_x, const double* beta, double* y,
            const int* step_y) {
  const bool transposes = !is(of_a, 'N');
  const int size_x = transposes ? *m : *n, size_y = transposes ? *n : *m;
  const ConstStepMap from(x, size_x, Eigen::InnerStride<>(*step_x));
  StepMap to(y, size_y, Eigen::InnerStride<>(*step_y));
  scale(to, *beta);
  const ConstMap A(a, *m, *n, Stride(*lda));
  if (transposes) {
    to.noalias() += *alpha * A.transpose() * from;
  } else {
    to.noalias() += *alpha * A * from;
  }
}

/// x = L^-1 x or L^-T x.
void dtrsv_(const char*, const char* of_a, const char*, const int* n, const double* a, const int* lda,
            double* x, const int*) {
  Eigen::Map<Eigen::VectorXd> solution(x, *n);
  const ConstMap A(a, *n, *n, Stride(*lda));
  if (is(of_a, 'N')) {
    A.triangularView<Eigen::Lower>().solveInPlace(solution);
  } else {
    A.transpose().triangularView<Eigen::Upper>().solveInPlace(solution);
  }
}

}  // extern "C"

namespace resilin {

std::string blas_kernel_name() { return "Eigen"; }
bool choose_blas_kernel() { return false; }
SingleThreadedBlas::SingleThreadedBlas(int num_calls, std::size_t) : num_calls_(num_calls) {}
SingleThreadedBlas::~SingleThreadedBlas() = default;

}  // namespace resilin
