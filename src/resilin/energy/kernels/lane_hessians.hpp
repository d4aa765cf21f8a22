#pragma once

#include "resilin/material/kernels/lane_tangent.hpp"

/// Hessians of one P1 element per lane, from the shape gradients g_a of nodes 1, 2, ...; node 0 follows from
/// translation invariance. Derivation: docs/theory/element_hessians.md.
namespace resilin::RESILIN_SIMD_NAMESPACE {

/// Place of block (a, b), a <= b, among the upper blocks of `num_nodes` nodes.
constexpr int pair_index(int num_nodes, int a, int b) { return a * num_nodes - a * (a - 1) / 2 + b - a; }

/// Upper blocks of an element: K[pair][dim * dim].
template <int dim, int num_nodes = dim + 1>
using ElementHessian = Lanes[num_nodes * (num_nodes + 1) / 2][dim * dim];

template <int dim>
RESILIN_INLINE void make_symmetric(Lanes block[]) {
  for (int i = 0; i < dim; ++i)
    for (int k = 0; k < i; ++k) block[dim * i + k] = block[dim * k + i];
}

/// Blocks of node 0: the sums over rows and columns vanish.
template <int dim, int n = dim + 1>
RESILIN_INLINE void complete_node_zero(ElementHessian<dim, n>& K) {
  for (int b = 1; b < n; ++b)
    for (int i = 0; i < dim; ++i)
      for (int k = 0; k < dim; ++k) {
        Lanes sum = 0.0;
        for (int a = 1; a < n; ++a)
          sum += a <= b ? K[pair_index(n, a, b)][dim * i + k] : K[pair_index(n, b, a)][dim * k + i];
        K[b][dim * i + k] = -sum;
      }
  for (int i = 0; i < dim; ++i)
    for (int k = i; k < dim; ++k) {
      Lanes sum = K[1][dim * k + i];
      for (int b = 2; b < n; ++b) sum += K[b][dim * k + i];
      K[0][dim * i + k] = -sum;
    }
  make_symmetric<dim>(K[0]);
}

/// Unprojected, with f_a = F g_a, c_a = cof F g_a and e_a = (I_C I - b) f_a, b = F F^T:
///
///   K_ab = 2 Psi_1 (g_a.g_b) I + Psi_J [F (g_a x g_b)]_x + p_a f_b^T + q_a c_b^T + r_a e_b^T
///        + Psi_2 (4 f_a f_b^T + 2 I_C (g_a.g_b) I - 2 ((f_a.f_b) I + f_b f_a^T + (g_a.g_b) b))
///
/// where p, q, r hold the second derivatives of Psi. No 9x9 matrix appears.
template <bool has_second_invariant>
RESILIN_INLINE void plain_hessian3(const Lanes F[9], const InvariantDerivatives& d, const Lanes g[3][3],
                                   Lanes w, ElementHessian<3>& K) {
  Lanes C[9], f[3][3], c[3][3];
  cofactor(F, C);
  apply<3>(F, g, f);
  apply<3>(C, g, c);
  [[maybe_unused]] Lanes e[3][3], b[9], I_C;
  if constexpr (has_second_invariant) {
    for (int i = 0; i < 3; ++i)
      for (int k = 0; k < 3; ++k) b[3 * i + k] = dot<3>(F + 3 * i, F + 3 * k);
    I_C = b[0] + b[4] + b[8];
    apply<3>(b, f, e);
    for (int a = 0; a < 3; ++a)
      for (int i = 0; i < 3; ++i) e[a][i] = I_C * f[a][i] - e[a][i];
  }
  const Lanes w1 = 2.0 * w * d.a1, wJ = w * d.aJ,
              w11 = 4.0 * w * (has_second_invariant ? d.h11 + d.a2 : d.h11);
  const Lanes w1J = 2.0 * w * d.h1J, wJJ = w * d.hJJ;
  [[maybe_unused]] const Lanes w2 = 2.0 * w * d.a2, w12 = 4.0 * w * d.h12, w2J = 2.0 * w * d.h2J,
                               w22 = 4.0 * w * d.h22;
  for (int a = 0; a < 3; ++a) {
    Lanes p[3], q[3];
    [[maybe_unused]] Lanes r[3];
    for (int i = 0; i < 3; ++i) {
      p[i] = w11 * f[a][i] + w1J * c[a][i];
      q[i] = w1J * f[a][i] + wJJ * c[a][i];
      if constexpr (has_second_invariant) {
        p[i] += w12 * e[a][i];
        q[i] += w2J * e[a][i];
        r[i] = w12 * f[a][i] + w2J * c[a][i] + w22 * e[a][i];
      }
    }
    for (int bb = a; bb < 3; ++bb) {
      Lanes* k = K[pair_index(4, a + 1, bb + 1)];
      const Lanes gg = dot<3>(g[a], g[bb]);
      Lanes diagonal = w1 * gg;
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) {
          Lanes sum = p[i] * f[bb][j] + q[i] * c[bb][j];
          if constexpr (has_second_invariant)
            sum += r[i] * e[bb][j] - w2 * (f[bb][i] * f[a][j] + gg * b[3 * i + j]);
          k[3 * i + j] = sum;
        }
      if constexpr (has_second_invariant) diagonal += w2 * (I_C * gg - dot<3>(f[a], f[bb]));
      for (int i = 0; i < 3; ++i) k[4 * i] += diagonal;
      if (a == bb) {
        make_symmetric<3>(k);
        continue;
      }
      const Lanes n[3] = {g[a][1] * g[bb][2] - g[a][2] * g[bb][1], g[a][2] * g[bb][0] - g[a][0] * g[bb][2],
                          g[a][0] * g[bb][1] - g[a][1] * g[bb][0]};
      const Lanes x = wJ * dot<3>(F, n), y = wJ * dot<3>(F + 3, n), z = wJ * dot<3>(F + 6, n);
      k[1] += z;
      k[3] -= z;
      k[2] -= y;
      k[6] += y;
      k[5] += x;
      k[7] -= x;
    }
  }
  complete_node_zero<3>(K);
}

/// The same in plane strain (I_C and J alone).
RESILIN_INLINE void plain_hessian2(const Lanes F[4], const InvariantDerivatives& d, const Lanes g[2][2],
                                   Lanes w, ElementHessian<2>& K) {
  const Lanes C[4] = {F[3], -F[2], -F[1], F[0]};
  Lanes f[2][2], c[2][2];
  apply<2>(F, g, f);
  apply<2>(C, g, c);
  const Lanes w11 = 4.0 * w * d.h11, w1J = 2.0 * w * d.h1J, wJJ = w * d.hJJ;
  for (int a = 0; a < 2; ++a)
    for (int b = a; b < 2; ++b) {
      Lanes* k = K[pair_index(3, a + 1, b + 1)];
      for (int i = 0; i < 2; ++i) {
        const Lanes p = w11 * f[a][i] + w1J * c[a][i], q = w1J * f[a][i] + wJJ * c[a][i];
        for (int j = 0; j < 2; ++j) k[2 * i + j] = p * f[b][j] + q * c[b][j];
      }
      const Lanes diagonal = 2.0 * w * d.a1 * dot<2>(g[a], g[b]);
      k[0] += diagonal;
      k[3] += diagonal;
      if (a == b) {
        make_symmetric<2>(k);
      } else {
        const Lanes z = w * d.aJ * (g[a][0] * g[b][1] - g[a][1] * g[b][0]);
        k[1] += z;
        k[2] -= z;
      }
    }
  complete_node_zero<2>(K);
}

/// Psi = a eps:eps + ... with b = d2Psi/d(tr eps)^2: K_ab = a ((g_a.g_b) I + g_b g_a^T) + b g_a g_b^T.
/// Constant and, for a solid that is stable at rest, positive.
template <int dim>
RESILIN_INLINE void small_strain_hessian(Lanes slope, Lanes curvature, const Lanes g[][dim], Lanes w,
                                         ElementHessian<dim>& K) {
  for (int a = 0; a < dim; ++a)
    for (int b = a; b < dim; ++b) {
      Lanes* k = K[pair_index(dim + 1, a + 1, b + 1)];
      const Lanes wa = w * slope, wb = w * curvature, diagonal = wa * dot<dim>(g[a], g[b]);
      for (int i = 0; i < dim; ++i)
        for (int j = 0; j < dim; ++j) k[dim * i + j] = wa * g[b][i] * g[a][j] + wb * g[a][i] * g[b][j];
      for (int i = 0; i < dim; ++i) k[(dim + 1) * i] += diagonal;
    }
  complete_node_zero<dim>(K);
}

/// From the closed eigensystem of isotropic energies. With F = U diag(s) V^T and h_a = V^T g_a, K_ab = U
/// Khat_ab U^T and
///
///   Khat_ii = S_ii h_ai h_bi + sum_j D_ij h_aj h_bj,   Khat_ij = S_ij h_ai h_bj + E_ij h_aj h_bi
///
/// D and E come from the flip and twist eigenvalues of the plane (i, j).
RESILIN_INLINE void principal_hessian3(const PrincipalTangent& t, const Column3 U[3], const Column3 V[3],
                                       const Lanes g[3][3], Lanes w, ElementHessian<3>& K) {
  const Lanes A[3][3] = {
      {t.S.m00, t.S.m01, t.S.m02}, {t.S.m01, t.S.m11, t.S.m12}, {t.S.m02, t.S.m12, t.S.m22}};
  Lanes D[3], E[3];  // by the third index
  for (int k = 0; k < 3; ++k) {
    D[k] = 0.5 * (t.flip[k] + t.twist[k]);
    E[k] = 0.5 * (t.flip[k] - t.twist[k]);
  }
  Lanes h[3][3];
  for (int a = 0; a < 3; ++a)
    for (int i = 0; i < 3; ++i) h[a][i] = g[a][0] * V[i][0] + g[a][1] * V[i][1] + g[a][2] * V[i][2];
  for (int a = 0; a < 3; ++a) {
    const Lanes wh[3] = {w * h[a][0], w * h[a][1], w * h[a][2]};
    for (int b = a; b < 3; ++b) {
      Lanes k[9], u[9];
      const Lanes p[3] = {wh[0] * h[b][0], wh[1] * h[b][1], wh[2] * h[b][2]};
      k[0] = A[0][0] * p[0] + D[2] * p[1] + D[1] * p[2];
      k[4] = D[2] * p[0] + A[1][1] * p[1] + D[0] * p[2];
      k[8] = D[1] * p[0] + D[0] * p[1] + A[2][2] * p[2];
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
          if (i != j) k[3 * i + j] = A[i][j] * (wh[i] * h[b][j]) + E[3 - i - j] * (wh[j] * h[b][i]);
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) u[3 * i + j] = U[0][i] * k[j] + U[1][i] * k[3 + j] + U[2][i] * k[6 + j];
      Lanes* out = K[pair_index(4, a + 1, b + 1)];
      for (int i = 0; i < 3; ++i)
        for (int j = a == b ? i : 0; j < 3; ++j)
          out[3 * i + j] = u[3 * i] * U[0][j] + u[3 * i + 1] * U[1][j] + u[3 * i + 2] * U[2][j];
      if (a == b) make_symmetric<3>(out);
    }
  }
  complete_node_zero<3>(K);
}

/// The same in plane strain: flip and twist eigenvalues 2 Psi_1 -/+ Psi_J.
RESILIN_INLINE void projected_hessian2(const Lanes H[4], const InvariantDerivatives& d, const Lanes g[2][2],
                                       Lanes w, double removed, ElementHessian<2>& K) {
  const Svd2 m = svd2(H);
  const auto &U = m.U, &V = m.V;
  const Lanes* s = m.s;
  const Lanes d1[2] = {2.0 * s[0], 2.0 * s[1]}, dJ[2] = {s[1], s[0]};
  const auto rank = [&](int i, int j) {
    return d1[i] * (d.h11 * d1[j] + d.h1J * dJ[j]) + dJ[i] * (d.h1J * d1[j] + d.hJJ * dJ[j]);
  };
  Lanes A00 = rank(0, 0) + 2.0 * d.a1, A11 = rank(1, 1) + 2.0 * d.a1, A01 = rank(0, 1) + d.aJ;
  // Eigenvalues mean +/- radius, projectors (I +/- N / radius) / 2 with N = A - mean I.
  const Lanes mean = 0.5 * (A00 + A11), half = 0.5 * (A00 - A11), radius2 = half * half + A01 * A01;
  const Lanes inverse = reciprocal_sqrt(radius2 + 1e-290), radius = radius2 * inverse;
  const Lanes n0 = removed * min(mean + radius, Lanes(0.0)), n1 = removed * min(mean - radius, Lanes(0.0));
  const Lanes both = 0.5 * (n0 + n1), apart = 0.5 * (n0 - n1) * inverse;
  A00 -= both + apart * half;
  A11 -= both - apart * half;
  A01 -= apart * A01;
  const Lanes flip = lifted(2.0 * d.a1 - d.aJ, removed), twist = lifted(2.0 * d.a1 + d.aJ, removed);
  const Lanes D = 0.5 * (flip + twist), E = 0.5 * (flip - twist);

  for (int a = 0; a < 2; ++a)
    for (int b = a; b < 2; ++b) {
      const Lanes ha[2] = {w * dot<2>(g[a], V[0]), w * dot<2>(g[a], V[1])};
      const Lanes hb[2] = {dot<2>(g[b], V[0]), dot<2>(g[b], V[1])};
      const Lanes k[4] = {A00 * ha[0] * hb[0] + D * ha[1] * hb[1], A01 * ha[0] * hb[1] + E * ha[1] * hb[0],
                          A01 * ha[1] * hb[0] + E * ha[0] * hb[1], D * ha[0] * hb[0] + A11 * ha[1] * hb[1]};
      Lanes* out = K[pair_index(3, a + 1, b + 1)];
      for (int i = 0; i < 2; ++i)
        for (int j = 0; j < 2; ++j)
          out[2 * i + j] =
              (U[0][i] * k[0] + U[1][i] * k[2]) * U[0][j] + (U[0][i] * k[1] + U[1][i] * k[3]) * U[1][j];
      if (a == b) make_symmetric<2>(out);
    }
  complete_node_zero<2>(K);
}

/// K_ab = w g_a^T A g_b of any stress tangent A (material/lane_tangent.hpp).
template <int dim>
RESILIN_INLINE void hessian_from_tangent(const Lanes A[], const Lanes g[dim][dim], Lanes w,
                                         ElementHessian<dim>& K) {
  constexpr int n = dim * dim;
  for (int b = 0; b < dim; ++b) {
    Lanes y[n][dim];  // sum_l A[(i k), (j l)] w g_bl
    for (int row = 0; row < n; ++row)
      for (int j = 0; j < dim; ++j) y[row][j] = w * dot<dim>(A + n * row + dim * j, g[b]);
    for (int a = 0; a <= b; ++a) {
      Lanes* block = K[pair_index(dim + 1, a + 1, b + 1)];
      for (int i = 0; i < dim; ++i)
        for (int j = 0; j < dim; ++j) {
          Lanes sum = g[a][0] * y[dim * i][j];
          for (int k = 1; k < dim; ++k) sum += g[a][k] * y[dim * i + k][j];
          block[dim * i + j] = sum;
        }
      if (a == b) make_symmetric<dim>(block);
    }
  }
  complete_node_zero<dim>(K);
}

}  // namespace resilin::RESILIN_SIMD_NAMESPACE
