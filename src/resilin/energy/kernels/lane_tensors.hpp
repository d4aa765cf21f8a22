#pragma once

#include "resilin/core/simd_svd.hpp"
#include "resilin/energy/kernels/element_kernels.hpp"

/// Kinematics and stress of one element per lane. Matrices are stored by rows. Formulas: material/derive.cpp,
/// the same ones written plainly.
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

/// The reduced invariants d1, d2, j (material/invariants.hpp); d2 = 0 where the law does not use it.
template <int dim>
RESILIN_INLINE void invariants(const Lanes H[], bool has_second_invariant, Lanes out[3]) {
  if constexpr (dim == 2) {
    const Lanes off = H[1] * H[2], det = H[0] * H[3] - off;
    const Lanes J = (1.0 + H[0]) * (1.0 + H[3]) - off;
    const Lanes j = select(J < Lanes(0.5), J - 1.0, H[0] + H[3] + det);
    out[0] = norm2<2>(H) - 2.0 * det;
    out[1] = out[0] + j * j;
    out[2] = j;
  } else {
    Lanes cof_H[9];
    cofactor(H, cof_H);
    const Lanes m2 = cof_H[0] + cof_H[4] + cof_H[8];
    const Lanes det = H[0] * cof_H[0] + H[1] * cof_H[1] + H[2] * cof_H[2];
    const Lanes F0 = 1.0 + H[0], F4 = 1.0 + H[4], F8 = 1.0 + H[8];
    const Lanes J =
        F0 * (F4 * F8 - H[5] * H[7]) + H[1] * (H[5] * H[6] - H[3] * F8) + H[2] * (H[3] * H[7] - F4 * H[6]);
    out[0] = norm2<3>(H) - 2.0 * (m2 + det);
    out[1] = 0.0;
    if (has_second_invariant) {
      Lanes Y[9];
      cofactor_minus_identity(H, cof_H, Y);
      out[1] = norm2<3>(Y) - (2.0 * m2 + 4.0 * det);
    }
    // Near J = 0 the determinant of F itself: a cell that is exactly flat must be seen as such.
    out[2] = select(J < Lanes(0.5), J - 1.0, H[0] + H[4] + H[8] + m2 + det);
  }
}

/// eps:eps, nothing and tr eps of the small strain eps = sym H.
template <int dim>
RESILIN_INLINE void small_strain(const Lanes H[], Lanes out[3]) {
  Lanes square = 0.0, trace = 0.0;
  for (int i = 0; i < dim; ++i) {
    trace += H[(dim + 1) * i];
    square += H[(dim + 1) * i] * H[(dim + 1) * i];
    for (int k = i + 1; k < dim; ++k) {
      const Lanes sum = H[dim * i + k] + H[dim * k + i];
      square += 0.5 * (sum * sum);
    }
  }
  out[0] = square;
  out[1] = 0.0;
  out[2] = trace;
}

/// P from the derivatives g of Psi with respect to the variables of the law's kind.
template <int dim>
RESILIN_INLINE void stress(const LawForm& form, const Lanes H[], const Lanes g[3], Lanes P[]) {
  if (form.kind == LawKind::small_strain) {
    for (int i = 0; i < dim; ++i)
      for (int k = 0; k < dim; ++k) P[dim * i + k] = g[0] * (H[dim * i + k] + H[dim * k + i]);
    for (int i = 0; i < dim; ++i) P[(dim + 1) * i] += g[2];
  } else if constexpr (dim == 2) {
    // d2 = d1 + j^2 in plane strain.
    const Lanes j = H[0] + H[3] + (H[0] * H[3] - H[1] * H[2]);
    const Lanes twice_g1 = 2.0 * (g[0] + g[1]), g_j = g[2] + 2.0 * j * g[1];
    const Lanes Y[4] = {H[3], -H[2], -H[1], H[0]};
    for (int i = 0; i < 4; ++i) P[i] = twice_g1 * (H[i] - Y[i]) + g_j * Y[i];
    P[0] += g_j;
    P[3] += g_j;
  } else {
    Lanes cof_H[9], Y[9];
    cofactor(H, cof_H);
    cofactor_minus_identity(H, cof_H, Y);
    const Lanes twice_g1 = g[0] + g[0], rest = g[2] - twice_g1;
    for (int i = 0; i < 9; ++i) P[i] = twice_g1 * H[i] + rest * Y[i];
    if (form.uses_second_invariant) {
      // d d2/dF = 2 (tr Y I - Y^T + H x Y - Y - cof H)
      const Lanes trace = Y[0] + Y[4] + Y[8], twice_g2 = g[1] + g[1];
      for (int i = 0; i < 3; ++i)
        for (int k = 0; k < 3; ++k) {
          const int i1 = (i + 1) % 3, i2 = (i + 2) % 3, k1 = (k + 1) % 3, k2 = (k + 2) % 3;
          const Lanes product = H[3 * i1 + k1] * Y[3 * i2 + k2] + H[3 * i2 + k2] * Y[3 * i1 + k1] -
                                H[3 * i1 + k2] * Y[3 * i2 + k1] - H[3 * i2 + k1] * Y[3 * i1 + k2];
          P[3 * i + k] += twice_g2 * (product - Y[3 * k + i] - Y[3 * i + k] - cof_H[3 * i + k]);
        }
      for (int i = 0; i < 3; ++i) P[4 * i] += twice_g2 * trace;
    }
    for (int i = 0; i < 3; ++i) P[4 * i] += g[2];
  }
}

/// Derivatives of Psi with respect to I_C, II_C and J.
struct InvariantDerivatives {
  Lanes a1, a2, aJ;
  Lanes h11, h12, h1J, h22, h2J, hJJ;
};

/// From those with respect to d1 = i1 - 2 j, d2 = i2 - 4 j and j, stored in rows (material/law_kernels.hpp).
RESILIN_INLINE InvariantDerivatives invariant_derivatives(const double* rows) {
  Lanes r[9];
  load_rows(rows, 9, r);
  return {r[0],
          r[1],
          r[2] - 2.0 * r[0] - 4.0 * r[1],
          r[3],
          r[4],
          r[5] - 2.0 * r[3] - 4.0 * r[4],
          r[6],
          r[7] - 2.0 * r[4] - 4.0 * r[6],
          r[8] - 4.0 * r[5] - 8.0 * r[7] + 4.0 * r[3] + 16.0 * (r[4] + r[6])};
}

/// The same in plane strain, where d2 = d1 + j^2 leaves I_C and J as variables.
RESILIN_INLINE InvariantDerivatives plane_strain_derivatives(const double* rows, Lanes j) {
  Lanes r[9];
  load_rows(rows, 9, r);
  const Lanes g1 = r[0] + r[1], gj = r[2] + 2.0 * j * r[1];
  const Lanes h11 = r[3] + 2.0 * r[4] + r[6], h1j = r[5] + r[7] + 2.0 * j * (r[4] + r[6]);
  const Lanes hjj = r[8] + 4.0 * j * (r[7] + j * r[6]) + 2.0 * r[1];
  const Lanes zero = 0.0;
  return {g1, zero, gj - 2.0 * g1, h11, zero, h1j - 2.0 * h11, zero, zero, hjj - 4.0 * h1j + 4.0 * h11};
}

}  // namespace resilin::RESILIN_SIMD_NAMESPACE
