#pragma once

#include "resilin/energy/kernels/lane_tensors.hpp"

/// Hessians of one P1 element per lane, from the shape gradients g_a of nodes 1, 2, ...; node 0 follows from
/// translation invariance. Derivation: docs/theory/element_hessians.md.
namespace resilin::RESILIN_SIMD_NAMESPACE {

/// Place of block (a, b), a <= b, among the upper blocks of `num_nodes` nodes.
constexpr int pair_index(int num_nodes, int a, int b) { return a * num_nodes - a * (a - 1) / 2 + b - a; }

/// Upper blocks of an element: K[pair][dim * dim].
template <int dim>
using ElementHessian = Lanes[(dim + 1) * (dim + 2) / 2][dim * dim];

template <int dim>
RESILIN_INLINE void make_symmetric(Lanes block[]) {
  for (int i = 0; i < dim; ++i)
    for (int k = 0; k < i; ++k) block[dim * i + k] = block[dim * k + i];
}

/// Blocks of node 0: the sums over rows and columns vanish.
template <int dim>
RESILIN_INLINE void complete_node_zero(ElementHessian<dim>& K) {
  constexpr int n = dim + 1;
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

/// y_a = A g_a for all gradients.
template <int dim>
RESILIN_INLINE void apply(const Lanes A[], const Lanes g[][dim], Lanes y[][dim]) {
  for (int a = 0; a < dim; ++a)
    for (int i = 0; i < dim; ++i) {
      y[a][i] = A[dim * i] * g[a][0];
      for (int k = 1; k < dim; ++k) y[a][i] += A[dim * i + k] * g[a][k];
    }
}

template <int dim>
RESILIN_INLINE Lanes dot(const Lanes a[], const Lanes b[]) {
  Lanes sum = a[0] * b[0];
  for (int i = 1; i < dim; ++i) sum += a[i] * b[i];
  return sum;
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

/// Projected by the closed eigensystem of isotropic energies (Smith, de Goes & Kim 2019; Poya, Gil & Ortigosa
/// 2023). With F = U diag(s) V^T and h_a = V^T g_a, K_ab = U Khat_ab U^T and
///
///   Khat_ii = A_ii h_ai h_bi + sum_j D_ij h_aj h_bj,   Khat_ij = A_ij h_ai h_bj + E_ij h_aj h_bi
///
/// A is the Hessian of Psi in the singular values; D and E come from the flip and twist eigenvalues of the
/// plane (i, j), k the third index, 2 Psi_1 + 2 Psi_2 (s_k^2 -/+ s_i s_j) -/+ Psi_J s_k: nothing is divided.
template <bool has_second_invariant>
RESILIN_INLINE void projected_hessian3(const Lanes F[9], const InvariantDerivatives& d, const Lanes g[3][3],
                                       Lanes w, double removed, ElementHessian<3>& K) {
  const Svd3 m = svd(F);
  const Lanes* s = m.s;
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
  Symmetric3 S = {diagonal(0), diagonal(1), diagonal(2), mixed(0, 1), mixed(0, 2), mixed(1, 2)};
  lift(S, removed);
  const Lanes A[3][3] = {{S.m00, S.m01, S.m02}, {S.m01, S.m11, S.m12}, {S.m02, S.m12, S.m22}};

  Lanes D[3], E[3];  // by the third index
  for (int k = 0; k < 3; ++k) {
    Lanes flip = two_a1 - d.aJ * s[k], twist = two_a1 + d.aJ * s[k];
    if constexpr (has_second_invariant) {
      const Lanes product = s[(k + 1) % 3] * s[(k + 2) % 3];
      flip += two_a2 * (q[k] - product);
      twist += two_a2 * (q[k] + product);
    }
    flip = lifted(flip, removed);
    twist = lifted(twist, removed);
    D[k] = 0.5 * (flip + twist);
    E[k] = 0.5 * (flip - twist);
  }

  Lanes h[3][3];
  for (int a = 0; a < 3; ++a)
    for (int i = 0; i < 3; ++i) h[a][i] = g[a][0] * m.V[i][0] + g[a][1] * m.V[i][1] + g[a][2] * m.V[i][2];
  for (int a = 0; a < 3; ++a) {
    const Lanes wh[3] = {w * h[a][0], w * h[a][1], w * h[a][2]};
    for (int b = a; b < 3; ++b) {
      Lanes k[9], t[9];
      const Lanes p[3] = {wh[0] * h[b][0], wh[1] * h[b][1], wh[2] * h[b][2]};
      k[0] = A[0][0] * p[0] + D[2] * p[1] + D[1] * p[2];
      k[4] = D[2] * p[0] + A[1][1] * p[1] + D[0] * p[2];
      k[8] = D[1] * p[0] + D[0] * p[1] + A[2][2] * p[2];
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
          if (i != j) k[3 * i + j] = A[i][j] * (wh[i] * h[b][j]) + E[3 - i - j] * (wh[j] * h[b][i]);
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
          t[3 * i + j] = m.U[0][i] * k[j] + m.U[1][i] * k[3 + j] + m.U[2][i] * k[6 + j];
      Lanes* out = K[pair_index(4, a + 1, b + 1)];
      for (int i = 0; i < 3; ++i)
        for (int j = a == b ? i : 0; j < 3; ++j)
          out[3 * i + j] = t[3 * i] * m.U[0][j] + t[3 * i + 1] * m.U[1][j] + t[3 * i + 2] * m.U[2][j];
      if (a == b) make_symmetric<3>(out);
    }
  }
  complete_node_zero<3>(K);
}

/// The same in plane strain: flip and twist eigenvalues 2 Psi_1 -/+ Psi_J.
RESILIN_INLINE void projected_hessian2(const Lanes F[4], const InvariantDerivatives& d, const Lanes g[2][2],
                                       Lanes w, double removed, ElementHessian<2>& K) {
  // F V = U diag(s): one rotation diagonalises F^T F, a second one on F V gives back its lost digits.
  Lanes V[2][2] = {{1.0, 0.0}, {0.0, 1.0}}, B[2][2] = {{F[0], F[2]}, {F[1], F[3]}};  // columns
  for (int sweep = 0; sweep < 2; ++sweep) {
    const Rotation2 r = jacobi_rotation(dot<2>(B[1], B[1]) - dot<2>(B[0], B[0]), dot<2>(B[0], B[1]));
    for (auto* columns : {&V, &B})
      for (int i = 0; i < 2; ++i) {
        const Lanes x = (*columns)[0][i], y = (*columns)[1][i];
        (*columns)[0][i] = r.c * x - r.s * y;
        (*columns)[1][i] = r.s * x + r.c * y;
      }
  }
  const Mask is_less = dot<2>(B[0], B[0]) < dot<2>(B[1], B[1]);
  for (auto* columns : {&V, &B})
    for (int i = 0; i < 2; ++i) {  // swap with a sign: stays a rotation
      const Lanes x = (*columns)[0][i], y = (*columns)[1][i];
      (*columns)[0][i] = select(is_less, y, x);
      (*columns)[1][i] = select(is_less, -x, y);
    }
  const Lanes norm = dot<2>(B[0], B[0]), r0 = reciprocal_sqrt(norm + 1e-290);
  const Mask is_null = norm < Lanes(1e-280);  // F = 0: any rotation serves
  const Lanes u0 = select(is_null, 1.0, B[0][0] * r0), u1 = select(is_null, 0.0, B[0][1] * r0);
  const Lanes U[2][2] = {{u0, u1}, {-u1, u0}};
  const Lanes s[2] = {norm * r0, dot<2>(U[1], B[1])};

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

}  // namespace resilin::RESILIN_SIMD_NAMESPACE
