#pragma once

#include "resilin/material/kernels/lane_stress.hpp"

/// dP/dF from what a law's kernel `curvature` gives, one state in each lane. Derivations:
/// docs/theory/element_hessians.md and docs/theory/stretches.md.
namespace resilin::RESILIN_SIMD_NAMESPACE {

/// Derivatives of Psi with respect to I_C, II_C and J.
struct InvariantDerivatives {
  Lanes a1, a2, aJ;
  Lanes h11, h12, h1J, h22, h2J, hJJ;
};

/// From those with respect to d1 = i1 - 2 j, d2 = i2 - 4 j and j, stored in rows
/// (material/kernels/law_kernels.hpp).
RESILIN_INLINE InvariantDerivatives invariant_derivatives(const Lanes r[9]) {
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

RESILIN_INLINE InvariantDerivatives invariant_derivatives(const double* rows) {
  Lanes r[9];
  load_rows(rows, 9, r);
  return invariant_derivatives(r);
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

/// Takes `removed` times the negative part off a number ...
RESILIN_INLINE Lanes lifted(Lanes x, double removed) { return x - removed * min(x, Lanes(0.0)); }

/// ... off a symmetric 3x3 matrix. Nothing is done when all lanes are safely positive definite.
RESILIN_INLINE void lift(Symmetric3& A, double removed) {
  const Lanes size = abs(A.m00) + abs(A.m11) + abs(A.m22);
  const Lanes minor2 = A.m00 * A.m11 - A.m01 * A.m01;
  const Lanes det = A.m22 * minor2 - A.m00 * (A.m12 * A.m12) - A.m02 * (A.m02 * A.m11 - A.m01 * A.m12) +
                    A.m01 * A.m02 * A.m12;
  const Mask is_safe =
      (A.m00 > 1e-10 * size) & (minor2 > 1e-12 * size * size) & (det > 1e-14 * size * size * size);
  if (!any(~is_safe)) return;
  Symmetric3 D = A;
  Column3 V[3];
  diagonalize(D, V, 4);
  const Lanes values[3] = {D.m00, D.m11, D.m22};
  for (int i = 0; i < 3; ++i) {
    const Lanes n = removed * min(values[i], Lanes(0.0));
    const Lanes x = n * V[i][0], y = n * V[i][1], z = n * V[i][2];
    A.m00 -= x * V[i][0];
    A.m11 -= y * V[i][1];
    A.m22 -= z * V[i][2];
    A.m01 -= x * V[i][1];
    A.m02 -= x * V[i][2];
    A.m12 -= y * V[i][2];
  }
}

/// ... off a symmetric matrix of n rows.
template <int n>
RESILIN_INLINE void lift(Lanes A[], double removed) {
  Lanes D[n][n], V[n][n];
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) D[i][j] = A[n * i + j];
  diagonalize<n>(D, V);
  for (int m = 0; m < n; ++m) {
    const Lanes negative = removed * min(D[m][m], Lanes(0.0));
    if (!any(negative < Lanes(0.0))) continue;
    for (int i = 0; i < n; ++i) {
      const Lanes x = negative * V[i][m];
      for (int j = 0; j < n; ++j) A[n * i + j] -= x * V[j][m];
    }
  }
}

/// d2Psi/dF2 of an isotropic law in the frame of the principal stretches: its closed eigensystem (Smith, de
/// Goes & Kim 2019; Poya, Gil & Ortigosa 2023).
struct PrincipalTangent {
  Symmetric3 S;    ///< the Hessian of Psi in the stretches
  Lanes flip[3];   ///< eigenvalues (W_i - W_j) / (s_i - s_j) by the third index ...
  Lanes twist[3];  ///< ... and (W_i + W_j) / (s_i + s_j)

  RESILIN_INLINE void project(double removed) {
    lift(S, removed);
    for (int k = 0; k < 3; ++k) {
      flip[k] = lifted(flip[k], removed);
      twist[k] = lifted(twist[k], removed);
    }
  }
};

/// For a law of invariants: flip and twist are 2 Psi_1 + 2 Psi_2 (s_k^2 -/+ s_i s_j) -/+ Psi_J s_k, so that
/// nothing is divided.
template <bool has_second_invariant>
RESILIN_INLINE PrincipalTangent principal_tangent(const InvariantDerivatives& d, const Lanes s[3]) {
  const Lanes q[3] = {s[0] * s[0], s[1] * s[1], s[2] * s[2]};
  const Lanes two_a1 = 2.0 * d.a1;
  [[maybe_unused]] const Lanes two_a2 = 2.0 * d.a2;
  Lanes d1[3], d2[3], dJ[3];  // derivatives of I_C, II_C, J by the singular values
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    d1[i] = 2.0 * s[i];
    d2[i] = d1[i] * (q[j] + q[k]);
    dJ[i] = s[j] * s[k];
  }
  const auto rank = [&](int i, int j) {
    Lanes sum = d1[i] * (d.h11 * d1[j] + d.h1J * dJ[j]) + dJ[i] * (d.h1J * d1[j] + d.hJJ * dJ[j]);
    if constexpr (has_second_invariant)
      sum += d.h12 * (d1[i] * d2[j] + d2[i] * d1[j]) + d2[i] * (d.h22 * d2[j] + d.h2J * dJ[j]) +
             d.h2J * dJ[i] * d2[j];
    return sum;
  };
  const auto diagonal = [&](int i) {
    Lanes sum = rank(i, i) + two_a1;
    if constexpr (has_second_invariant) sum += two_a2 * (q[(i + 1) % 3] + q[(i + 2) % 3]);
    return sum;
  };
  const auto mixed = [&](int i, int j) {
    Lanes sum = rank(i, j) + d.aJ * s[3 - i - j];
    if constexpr (has_second_invariant) sum += 2.0 * two_a2 * s[i] * s[j];
    return sum;
  };
  PrincipalTangent t;
  t.S = {diagonal(0), diagonal(1), diagonal(2), mixed(0, 1), mixed(0, 2), mixed(1, 2)};
  for (int k = 0; k < 3; ++k) {
    t.flip[k] = two_a1 - d.aJ * s[k];
    t.twist[k] = two_a1 + d.aJ * s[k];
    if constexpr (has_second_invariant) {
      const Lanes product = s[(k + 1) % 3] * s[(k + 2) % 3];
      t.flip[k] += two_a2 * (q[k] - product);
      t.twist[k] += two_a2 * (q[k] + product);
    }
  }
  return t;
}

/// For a law of stretches, from the rows of its kernel.
RESILIN_INLINE PrincipalTangent principal_tangent(const double* rows) {
  Lanes r[15];
  load_rows(rows, 15, r);
  PrincipalTangent t;
  t.S = {r[3], r[6], r[8], r[4], r[5], r[7]};
  for (int k = 0; k < 3; ++k) {
    t.flip[k] = r[9 + k];
    t.twist[k] = r[12 + k];
  }
  return t;
}

/// A[(i k), (j l)] = dP_ik/dF_jl from the frame: with Q_pq = U_p V_q^T,
///
///   A = sum_pr S_pr Q_pp Q_rr^T + sum_k (flip_k f_k f_k^T + twist_k t_k t_k^T),
///   f_k, t_k = (Q_pq +/- Q_qp) / sqrt(2), k the third index.
template <int dim>
RESILIN_INLINE void assemble_tangent(const PrincipalTangent& t, const Lanes frame[], Lanes A[]) {
  constexpr int n = dim * dim, pairs = dim == 3 ? 3 : 1;
  const Lanes *U = frame, *V = frame + n;
  const Lanes S[3][3] = {
      {t.S.m00, t.S.m01, t.S.m02}, {t.S.m01, t.S.m11, t.S.m12}, {t.S.m02, t.S.m12, t.S.m22}};
  Lanes left[dim + 2 * pairs][n], right[dim + 2 * pairs][n];
  for (int i = 0; i < dim; ++i)
    for (int k = 0; k < dim; ++k) {
      for (int p = 0; p < dim; ++p) right[p][dim * i + k] = U[dim * p + i] * V[dim * p + k];
      for (int m = 0; m < pairs; ++m) {
        const int third = dim == 3 ? m : 2, p = (third + 1) % 3, q = (third + 2) % 3;
        const Lanes x = U[dim * p + i] * V[dim * q + k], y = U[dim * q + i] * V[dim * p + k];
        right[dim + 2 * m][dim * i + k] = x + y;
        right[dim + 2 * m + 1][dim * i + k] = x - y;
      }
    }
  for (int a = 0; a < n; ++a) {
    for (int p = 0; p < dim; ++p) {
      left[p][a] = S[p][0] * right[0][a];
      for (int r = 1; r < dim; ++r) left[p][a] += S[p][r] * right[r][a];
    }
    for (int m = 0; m < pairs; ++m) {
      const int third = dim == 3 ? m : 2;
      left[dim + 2 * m][a] = 0.5 * t.flip[third] * right[dim + 2 * m][a];
      left[dim + 2 * m + 1][a] = 0.5 * t.twist[third] * right[dim + 2 * m + 1][a];
    }
  }
  for (int a = 0; a < n; ++a)
    for (int b = a; b < n; ++b) {
      Lanes sum = left[0][a] * right[0][b];
      for (int m = 1; m < dim + 2 * pairs; ++m) sum += left[m][a] * right[m][b];
      A[n * a + b] = sum;
      A[n * b + a] = sum;
    }
}

/// Unprojected, of a law of invariants or fibres: with y_m the gradients of the variables, h_mn and Psi_m the
/// derivatives of Psi, A = sum_mn h_mn y_m y_n^T + sum_m Psi_m d2(variable m)/dF2.
template <int num_families>
RESILIN_INLINE void plain_tangent3(const Lanes H[9], const InvariantDerivatives& d, bool has_second_invariant,
                                   const Lanes directions[], const Lanes fibre_slopes[],
                                   const Lanes mixed[][3 + 2], Lanes A[81]) {
  Lanes F[9], gradients[3 + num_families][9];
  for (int i = 0; i < 9; ++i) F[i] = H[i];
  add_identity<3>(F);
  Lanes C[9], b[9], FC[9];
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k) {
      b[3 * i + k] = dot<3>(F + 3 * i, F + 3 * k);
      C[3 * i + k] = F[i] * F[k] + F[3 + i] * F[3 + k] + F[6 + i] * F[6 + k];
    }
  const Lanes I_C = b[0] + b[4] + b[8];
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k)
      FC[3 * i + k] = F[3 * i] * C[k] + F[3 * i + 1] * C[3 + k] + F[3 * i + 2] * C[6 + k];
  cofactor(F, gradients[2]);
  for (int i = 0; i < 9; ++i) {
    gradients[0][i] = 2.0 * F[i];
    gradients[1][i] = 2.0 * (I_C * F[i] - FC[i]);
  }
  for (int m = 0; m < num_families; ++m)
    for (int i = 0; i < 3; ++i) {
      const Lanes twice = 2.0 * dot<3>(F + 3 * i, directions + 3 * m);
      for (int k = 0; k < 3; ++k) gradients[3 + m][3 * i + k] = twice * directions[3 * m + k];
    }
  Lanes h[3 + num_families][3 + num_families];
  const Lanes base[3][3] = {{d.h11, d.h12, d.h1J}, {d.h12, d.h22, d.h2J}, {d.h1J, d.h2J, d.hJJ}};
  for (int m = 0; m < 3 + num_families; ++m)
    for (int n = 0; n < 3 + num_families; ++n)
      h[m][n] = m < 3 && n < 3 ? base[m][n] : m >= 3 ? mixed[m - 3][n] : mixed[n - 3][m];

  const Lanes two_a1 = 2.0 * d.a1, two_a2 = 2.0 * d.a2;
  for (int a = 0; a < 9; ++a) {
    const int i = a / 3, k = a % 3;
    Lanes left[3 + num_families];
    for (int n = 0; n < 3 + num_families; ++n) {
      left[n] = h[0][n] * gradients[0][a];
      for (int m = 1; m < 3 + num_families; ++m) left[n] += h[m][n] * gradients[m][a];
    }
    for (int c = a; c < 9; ++c) {
      const int j = c / 3, l = c % 3;
      Lanes sum = left[0] * gradients[0][c];
      for (int n = 1; n < 3 + num_families; ++n) sum += left[n] * gradients[n][c];
      if (a == c) sum += two_a1;
      if (has_second_invariant) {
        Lanes second = 2.0 * F[c] * F[a] - F[3 * i + l] * F[3 * j + k];
        if (k == l) second -= b[3 * i + j];
        if (i == j) second -= C[3 * k + l];
        if (a == c) second += I_C;
        sum += two_a2 * second;
      }
      if (i != j && k != l) {  // d cof_ik/dF_jl = +/- F_mn, m and n the third indices
        const bool is_plus = ((j - i + 3) % 3 == 1) == ((l - k + 3) % 3 == 1);
        const Lanes entry = F[3 * (3 - i - j) + 3 - k - l];
        sum += is_plus ? d.aJ * entry : -(d.aJ * entry);
      }
      if (i == j)
        for (int m = 0; m < num_families; ++m)
          sum += 2.0 * fibre_slopes[m] * directions[3 * m + k] * directions[3 * m + l];
      A[9 * a + c] = sum;
      A[9 * c + a] = sum;
    }
  }
}

/// The entries of the plane.
RESILIN_INLINE void restrict_to_plane(const Lanes A[81], Lanes plane[16]) {
  constexpr int place[4] = {0, 1, 3, 4};
  for (int a = 0; a < 4; ++a)
    for (int c = 0; c < 4; ++c) plane[4 * a + c] = A[9 * place[a] + place[c]];
}

/// Rows of a law of fibres: the derivatives by I_C, II_C and J from those by d1, d2 and j, and those that the
/// fibres take part in.
struct FibreDerivatives {
  InvariantDerivatives isotropic;
  Lanes slopes[2];
  Lanes mixed[2][5];  ///< by family, then I_C, II_C, J and the families

  RESILIN_INLINE explicit FibreDerivatives(const double* rows) {
    Lanes r[20];
    load_rows(rows, 20, r);
    constexpr int place[5][5] = {
        {5, 6, 7, 8, 9}, {6, 10, 11, 12, 13}, {7, 11, 14, 15, 16}, {8, 12, 15, 17, 18}, {9, 13, 16, 18, 19}};
    const Lanes base[9] = {r[0], r[1], r[2], r[5], r[6], r[7], r[10], r[11], r[14]};
    isotropic = invariant_derivatives(base);
    for (int m = 0; m < 2; ++m) {
      slopes[m] = r[3 + m];
      mixed[m][0] = r[place[3 + m][0]];
      mixed[m][1] = r[place[3 + m][1]];
      mixed[m][2] = r[place[3 + m][2]] - 2.0 * mixed[m][0] - 4.0 * mixed[m][1];
      for (int n = 0; n < 2; ++n) mixed[m][3 + n] = r[place[3 + m][3 + n]];
    }
  }
};

/// Unprojected, of a law of axes, from the rows of its kernel: with y_m the gradients of the variables,
/// A = sum_mn h_mn y_m y_n^T, and dF S dF of the strains and Psi_j of the second derivative of J beside.
RESILIN_INLINE void axes_tangent3(const Lanes H[9], const double* directions, const double* rows,
                                  Lanes A[81]) {
  constexpr int n = 7;
  Lanes F[9], a[9], Fa[9], S[9], y[n][9], g[n];
  for (int i = 0; i < 9; ++i) F[i] = H[i];
  add_identity<3>(F);
  load_rows(rows, n, g);
  material_axes(directions, a);
  axes_second_stress(a, g, S);
  for (int axis = 0; axis < 3; ++axis)
    for (int i = 0; i < 3; ++i) Fa[3 * axis + i] = dot<3>(F + 3 * i, a + 3 * axis);
  for (const AxesPair& pair : axes_pairs)
    for (int i = 0; i < 3; ++i)
      for (int k = 0; k < 3; ++k)
        y[pair.row][3 * i + k] =
            0.5 * (Fa[3 * pair.p + i] * a[3 * pair.q + k] + Fa[3 * pair.q + i] * a[3 * pair.p + k]);
  cofactor(F, y[2]);
  Lanes h[n][n];
  for (int m = 0, place = n; m < n; ++m)
    for (int k = m; k < n; ++k, ++place) h[m][k] = h[k][m] = Lanes::load(rows + place * block_size);
  for (int p = 0; p < 9; ++p) {
    const int i = p / 3, k = p % 3;
    Lanes left[n];
    for (int m = 0; m < n; ++m) {
      left[m] = h[0][m] * y[0][p];
      for (int q = 1; q < n; ++q) left[m] += h[q][m] * y[q][p];
    }
    for (int q = p; q < 9; ++q) {
      const int j = q / 3, l = q % 3;
      Lanes sum = left[0] * y[0][q];
      for (int m = 1; m < n; ++m) sum += left[m] * y[m][q];
      if (i == j) sum += S[3 * k + l];
      if (i != j && k != l) {  // d cof_ik/dF_jl = +/- F_mn, m and n the third indices
        const bool is_plus = ((j - i + 3) % 3 == 1) == ((l - k + 3) % 3 == 1);
        const Lanes entry = F[3 * (3 - i - j) + 3 - k - l];
        sum += is_plus ? g[2] * entry : -(g[2] * entry);
      }
      A[9 * p + q] = sum;
      A[9 * q + p] = sum;
    }
  }
}

template <int dim>
RESILIN_INLINE void small_strain_tangent(const double* rows, Lanes A[]) {
  const Lanes slope = Lanes::load(rows), curvature = Lanes::load(rows + 8 * block_size);
  constexpr int n = dim * dim;
  for (int a = 0; a < n; ++a)
    for (int c = 0; c < n; ++c) {
      const int i = a / dim, k = a % dim, j = c / dim, l = c % dim;
      Lanes sum = 0.0;
      if (i == j && k == l) sum += slope;
      if (i == l && k == j) sum += slope;
      if (i == k && j == l) sum += curvature;
      A[n * a + c] = sum;
    }
}

/// The frame of the principal stretches of a law of invariants.
RESILIN_INLINE void frame_of(const Svd3& m, Lanes frame[18]) {
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k) {
      frame[3 * i + k] = m.U[i][k];
      frame[9 + 3 * i + k] = m.V[i][k];
    }
}

/// dP_ik/dF_jl by rows (i k), columns (j l), for a law of any kind; `removed` times the negative part of its
/// eigenvalues is taken off. `frame`: of a law of stretches.
template <int dim>
RESILIN_INLINE void tangent(const LawForm& law, double removed, const Lanes H[], const Lanes frame[],
                            const double* directions, const double* rows, Lanes A[]) {
  if (law.kind == LawKind::small_strain) return small_strain_tangent<dim>(rows, A);
  const bool is_projected = removed > 0;
  if (law.kind == LawKind::stretches) {
    PrincipalTangent t = principal_tangent(rows);
    if (dim == 3 && is_projected) t.project(removed);
    assemble_tangent<dim>(t, frame, A);
    if constexpr (dim == 3) return;
  } else if (dim == 3 && is_projected && law.kind == LawKind::invariants) {
    if constexpr (dim == 3) {
      const InvariantDerivatives d = invariant_derivatives(rows);
      const Svd3 m = svd<false>(H);
      PrincipalTangent t =
          law.uses_second_invariant ? principal_tangent<true>(d, m.s) : principal_tangent<false>(d, m.s);
      t.project(removed);
      Lanes own_frame[18];
      frame_of(m, own_frame);
      return assemble_tangent<3>(t, own_frame, A);
    }
  } else {
    Lanes H3[9], A3[81];
    embed<dim>(H, H3);
    if (law.kind == LawKind::fibres) {
      const FibreDerivatives d(rows);
      Lanes a[6];
      load_rows(directions, 6, a);
      plain_tangent3<2>(H3, d.isotropic, law.uses_second_invariant, a, d.slopes, d.mixed, A3);
    } else if (law.kind == LawKind::axes) {
      axes_tangent3(H3, directions, rows, A3);
    } else {
      plain_tangent3<0>(H3, invariant_derivatives(rows), law.uses_second_invariant, nullptr, nullptr, nullptr,
                        A3);
    }
    if constexpr (dim == 2) {
      restrict_to_plane(A3, A);
    } else {
      for (int i = 0; i < 81; ++i) A[i] = A3[i];
    }
  }
  if (is_projected) lift<dim * dim>(A, removed);
}

}  // namespace resilin::RESILIN_SIMD_NAMESPACE
