#pragma once

#include "resilin/material/kernels/lane_variables.hpp"

/// P = dPsi/dF from what a law's kernel `gradient` gives, one state in each lane.
namespace resilin::RESILIN_SIMD_NAMESPACE {

/// P from the derivatives g of Psi with respect to Invariants or SmallStrain.
template <int dim>
RESILIN_INLINE void isotropic_stress(const LawForm& form, const Lanes H[], const Lanes g[3], Lanes P[]) {
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

/// P = sum_i W_i U_i V_i^T.
template <int dim>
RESILIN_INLINE void stretch_stress(const Lanes frame[], const Lanes g[], Lanes P[]) {
  const Lanes *U = frame, *V = frame + dim * dim;
  for (int i = 0; i < dim; ++i)
    for (int k = 0; k < dim; ++k) {
      P[dim * i + k] = g[0] * U[i] * V[k];
      for (int m = 1; m < dim; ++m) P[dim * i + k] += g[m] * U[dim * m + i] * V[dim * m + k];
    }
}

/// The isotropic part and 2 Psi_a (F a) a^T for each family of fibres.
template <int dim>
RESILIN_INLINE void fibre_stress(const LawForm& form, const Lanes H[], const Lanes g[5],
                                 const double* directions, Lanes P[]) {
  Lanes H3[9], P3[9];
  embed<dim>(H, H3);
  isotropic_stress<3>({LawKind::invariants, form.uses_second_invariant}, H3, g, P3);
  for (int family = 0; family < 2; ++family) {
    Lanes a[3];
    load_rows(directions + family * 3 * block_size, 3, a);
    for (int i = 0; i < 3; ++i) {
      const Lanes Fa = a[i] + dot<3>(H3 + 3 * i, a), twice = 2.0 * g[3 + family] * Fa;
      for (int k = 0; k < 3; ++k) P3[3 * i + k] += twice * a[k];
    }
  }
  for (int i = 0; i < dim; ++i)
    for (int k = 0; k < dim; ++k) P[dim * i + k] = P3[3 * i + k];
}

/// Where the variables of AxesStrain have the strain of two axes.
struct AxesPair {
  int row, p, q;
};
constexpr AxesPair axes_pairs[6] = {{0, 0, 0}, {1, 1, 1}, {3, 2, 2}, {4, 0, 1}, {5, 1, 2}, {6, 2, 0}};

/// The second Piola-Kirchhoff stress of the derivatives by the strains alone.
RESILIN_INLINE void axes_second_stress(const Lanes a[9], const Lanes g[7], Lanes S[9]) {
  for (int i = 0; i < 9; ++i) S[i] = 0.0;
  for (const AxesPair& pair : axes_pairs) {
    const Lanes half = 0.5 * g[pair.row];
    for (int i = 0; i < 3; ++i)
      for (int k = 0; k < 3; ++k)
        S[3 * i + k] +=
            half * (a[3 * pair.p + i] * a[3 * pair.q + k] + a[3 * pair.q + i] * a[3 * pair.p + k]);
  }
}

/// F S + Psi_j cof F.
template <int dim>
RESILIN_INLINE void axes_stress(const Lanes H[], const Lanes g[7], const double* directions, Lanes P[]) {
  Lanes H3[9], a[9], S[9], cof_H[9], Y[9];
  embed<dim>(H, H3);
  material_axes(directions, a);
  axes_second_stress(a, g, S);
  cofactor(H3, cof_H);
  cofactor_minus_identity(H3, cof_H, Y);
  for (int i = 0; i < dim; ++i)
    for (int k = 0; k < dim; ++k) {
      Lanes sum = S[3 * i + k] + g[2] * Y[3 * i + k];
      for (int m = 0; m < 3; ++m) sum += H3[3 * i + m] * S[3 * m + k];
      P[dim * i + k] = i == k ? sum + g[2] : sum;
    }
}

/// P for a law of any kind, from H (not for stretches) or the frame (for stretches alone).
template <int dim>
RESILIN_INLINE void stress(const LawForm& law, const Lanes H[], const Lanes frame[], const double* directions,
                           const Lanes g[], Lanes P[]) {
  switch (law.kind) {
    case LawKind::stretches:
      stretch_stress<dim>(frame, g, P);
      break;
    case LawKind::fibres:
      fibre_stress<dim>(law, H, g, directions, P);
      break;
    case LawKind::axes:
      axes_stress<dim>(H, g, directions, P);
      break;
    default:
      isotropic_stress<dim>(law, H, g, P);
  }
}

}  // namespace resilin::RESILIN_SIMD_NAMESPACE
