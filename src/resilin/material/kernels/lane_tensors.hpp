#pragma once

#include "resilin/core/simd.hpp"

/// Small matrices, one in each lane, stored by rows.
namespace resilin::RESILIN_SIMD_NAMESPACE {

RESILIN_INLINE void load_rows(const double* rows, int count, Lanes* out) {
  for (int i = 0; i < count; ++i) out[i] = Lanes::load(rows + i * block_size);
}
RESILIN_INLINE void store_rows(const Lanes* in, int count, double* rows) {
  for (int i = 0; i < count; ++i) in[i].store(rows + i * block_size);
}

RESILIN_INLINE void cofactor(const Lanes A[9], Lanes C[9]) {
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      const int i1 = (i + 1) % 3, i2 = (i + 2) % 3, j1 = (j + 1) % 3, j2 = (j + 2) % 3;
      C[3 * i + j] = A[3 * i1 + j1] * A[3 * i2 + j2] - A[3 * i1 + j2] * A[3 * i2 + j1];
    }
}

template <int dim>
RESILIN_INLINE Lanes norm2(const Lanes A[]) {
  Lanes sum = A[0] * A[0];
  for (int i = 1; i < dim * dim; ++i) sum += A[i] * A[i];
  return sum;
}

template <int dim>
RESILIN_INLINE void add_identity(Lanes A[]) {
  for (int i = 0; i < dim; ++i) A[(dim + 1) * i] += 1.0;
}

/// Y = cof F - I from H = F - I.
RESILIN_INLINE void cofactor_minus_identity(const Lanes H[9], const Lanes cof_H[9], Lanes Y[9]) {
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) Y[3 * i + j] = cof_H[3 * i + j] - H[3 * j + i];
  const Lanes trace = H[0] + H[4] + H[8];
  for (int i = 0; i < 3; ++i) Y[4 * i] += trace;
}

/// The sum of products of n numbers.
template <int n>
RESILIN_INLINE Lanes dot(const Lanes a[], const Lanes b[]) {
  Lanes sum = a[0] * b[0];
  for (int i = 1; i < n; ++i) sum += a[i] * b[i];
  return sum;
}

/// y_a = A g_a for all gradients.
template <int dim>
RESILIN_INLINE void apply(const Lanes A[], const Lanes g[][dim], Lanes y[][dim]) {
  for (int a = 0; a < dim; ++a)
    for (int i = 0; i < dim; ++i) {
      y[a][i] = A[dim * i] * g[a][0];
      for (int k = 1; k < dim; ++k) y[a][i] += A[dim * i + k] * g[a][k];
    }
}

/// The plane strain state diag(A_2, 0) of a matrix in two dimensions; a copy in three.
template <int dim>
RESILIN_INLINE void embed(const Lanes A[], Lanes A3[9]) {
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k) A3[3 * i + k] = i < dim && k < dim ? A[dim * i + k] : Lanes(0.0);
}

}  // namespace resilin::RESILIN_SIMD_NAMESPACE
