#pragma once

#include "resilin/core/simd_intrinsics.hpp"

#include <initializer_list>

/// Singular values and eigenvalues of small matrices, one matrix in each lane, without branches.
namespace resilin::RESILIN_SIMD_NAMESPACE {

/// A vector or a column of three.
struct Column3 {
  Lanes x[3];
  RESILIN_INLINE Lanes& operator[](int i) { return x[i]; }
  RESILIN_INLINE const Lanes& operator[](int i) const { return x[i]; }
};
RESILIN_INLINE Lanes dot(const Column3& a, const Column3& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
RESILIN_INLINE Column3 cross(const Column3& a, const Column3& b) {
  return {{a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]}};
}

/// Cosine and sine of a plane rotation.
struct Rotation2 {
  Lanes c, s;
};

/// The smaller rotation that diagonalises [[p, g], [g, p + d]]: (x, y) -> (c x - s y, s x + c y). The tiny
/// numbers make it the identity where d = g = 0.
RESILIN_INLINE Rotation2 jacobi_rotation(Lanes d, Lanes g) {
  const Lanes g2 = g + g;
  const Lanes r = reciprocal_sqrt(d * d + g2 * g2 + 1e-290);
  const Lanes c2 = 0.5 + 0.5 * ((abs(d) + 1e-145) * r);  // cos^2, in [1/2, 1]
  const Lanes rc = reciprocal_sqrt(c2);
  return {c2 * rc, select(d < Lanes(0), -g, g) * (r * rc)};
}

/// Rotates two columns: (a, b) -> (c a - s b, s a + c b).
RESILIN_INLINE void rotate(const Rotation2& q, Column3& a, Column3& b) {
  for (int k = 0; k < 3; ++k) {
    const Lanes x = a[k], y = b[k];
    a[k] = q.c * x - q.s * y;
    b[k] = q.s * x + q.c * y;
  }
}

/// One two-sided Jacobi rotation of a symmetric 3x3 matrix in the plane (p, q), r the third index.
RESILIN_INLINE void rotate_symmetric(Lanes& pp, Lanes& qq, Lanes& pq, Lanes& pr, Lanes& qr, Column3& v_p,
                                     Column3& v_q) {
  const Lanes d = qq - pp;
  const Rotation2 q = jacobi_rotation(d, pq);
  const Lanes cs = q.c * q.s, shift = (cs + cs) * pq - q.s * q.s * d;
  pp -= shift;
  qq += shift;
  pq = 0.0;
  const Lanes x = pr, y = qr;
  pr = q.c * x - q.s * y;
  qr = q.s * x + q.c * y;
  rotate(q, v_p, v_q);
}

/// Symmetric 3x3 matrix.
struct Symmetric3 {
  Lanes m00, m11, m22, m01, m02, m12;
};

/// Sets the columns of the identity matrix.
RESILIN_INLINE void set_identity(Column3 V[3]) {
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k) V[i][k] = i == k ? 1.0 : 0.0;
}

/// Cyclic Jacobi: on return the diagonal of `A` holds the eigenvalues and V[i] the i-th eigenvector.
RESILIN_INLINE void diagonalize(Symmetric3& A, Column3 V[3], int sweeps) {
  set_identity(V);
  for (int sweep = 0; sweep < sweeps; ++sweep) {
    rotate_symmetric(A.m00, A.m11, A.m01, A.m02, A.m12, V[0], V[1]);
    rotate_symmetric(A.m00, A.m22, A.m02, A.m01, A.m12, V[0], V[2]);
    rotate_symmetric(A.m11, A.m22, A.m12, A.m01, A.m02, V[1], V[2]);
  }
}

/// A unit vector in the plane normal to the unit vector u.
RESILIN_INLINE Column3 some_normal(const Column3& u) {
  const Mask is_along_x = abs(u[0]) > Lanes(0.8);  // then take y, else x
  const Lanes along = select(is_along_x, u[1], u[0]);
  Column3 n = {{-along * u[0], -along * u[1], -along * u[2]}};
  n[0] += select(is_along_x, 0.0, 1.0);
  n[1] += select(is_along_x, 1.0, 0.0);
  const Lanes r = reciprocal_sqrt(dot(n, n));
  for (int k = 0; k < 3; ++k) n[k] *= r;
  return n;
}

/// F = I + H = sum_i s_i U_i V_i^T with proper rotations U and V, |s_0| >= |s_1| >= |s_2| and only s_2
/// negative where det F is.
struct Svd3 {
  Column3 U[3], V[3];
  Lanes s[3];
  Lanes e[3];  ///< s - 1, to all its digits at small strain
};

/// Puts the columns in the order of falling length; a swap changes a sign, so that rotations stay such.
RESILIN_INLINE void sort_columns(Lanes norm2[3], Column3 G[3], Column3 V[3]) {
  for (int p = 0; p < 2; ++p)
    for (int q = p + 1; q < 3; ++q) {
      const Mask is_less = norm2[p] < norm2[q];
      const auto swap = [is_less](Lanes& a, Lanes& b, double sign) {
        const Lanes t = a;
        a = select(is_less, b, a);
        b = select(is_less, sign * t, b);
      };
      swap(norm2[p], norm2[q], 1);
      for (int k = 0; k < 3; ++k) {
        swap(G[p][k], G[q][k], -1);
        swap(V[p][k], V[q][k], -1);
      }
    }
}

/// Completes columns F v_j of falling length, v_j the columns of V, to U and s: Gram-Schmidt, so that U is a
/// rotation also where singular values vanish.
RESILIN_INLINE void complete_svd(const Column3 B[3], Svd3& r) {
  const Lanes length2 = dot(B[0], B[0]);
  const Mask is_null = length2 < Lanes(1e-280);
  const Lanes r0 = reciprocal_sqrt(length2 + 1e-290);
  for (int k = 0; k < 3; ++k) r.U[0][k] = select(is_null, k == 0 ? 1.0 : 0.0, B[0][k] * r0);
  Column3 w = B[1];
  for (int pass = 0; pass < 2; ++pass) {  // twice is enough, also where B_1 is round-off along U_0
    const Lanes d = dot(r.U[0], w);
    for (int k = 0; k < 3; ++k) w[k] = w[k] - d * r.U[0][k];
  }
  const Lanes width2 = dot(w, w);
  const Mask is_line = width2 < 1e-40 * length2 + 1e-280;
  const Lanes r1 = reciprocal_sqrt(width2 + 1e-290);
  for (int k = 0; k < 3; ++k) r.U[1][k] = w[k] * r1;
  if (any(is_line)) {
    const Column3 n = some_normal(r.U[0]);
    for (int k = 0; k < 3; ++k) r.U[1][k] = select(is_line, n[k], r.U[1][k]);
  }
  r.U[2] = cross(r.U[0], r.U[1]);
  r.s[0] = length2 * r0;
  r.s[1] = dot(r.U[1], B[1]);
  r.s[2] = dot(r.U[2], B[2]);
}

/// Three two-sided sweeps on F^T F - I, then one one-sided sweep on F V, which gives back the digits that
/// F^T F lost: reconstruction to 5e-15 |F|, also at condition 1e6, and to 5e-13 where all of F is below 0.1
/// (measured). When `keeps_strain`, F V is kept as V + H V, r.e has its digits at small strain, and the
/// reconstruction loses another 1e-15 / s_1; else r.e is not set.
template <bool keeps_strain>
RESILIN_INLINE Svd3 svd(const Lanes H[9] /* row-major */) {
  Svd3 r;
  Column3 columns[3];
  for (int j = 0; j < 3; ++j) columns[j] = {{H[j], H[3 + j], H[6 + j]}};
  const auto strain = [&](int i, int j) { return H[3 * i + j] + H[3 * j + i] + dot(columns[i], columns[j]); };
  Symmetric3 A = {strain(0, 0), strain(1, 1), strain(2, 2), strain(0, 1), strain(0, 2), strain(1, 2)};
  diagonalize(A, r.V, 3);
  Column3 G[3];  // H V, or F V
  for (int j = 0; j < 3; ++j)
    for (int i = 0; i < 3; ++i) {
      G[j][i] = columns[0][i] * r.V[j][0] + columns[1][i] * r.V[j][1] + columns[2][i] * r.V[j][2];
      if (!keeps_strain) G[j][i] += r.V[j][i];
    }
  // (F v).(F w) for orthonormal v and w; less 1 for v = w, when the strain is kept
  const auto inner = [&](int p, int q) {
    Lanes product = dot(G[p], G[q]);
    if (keeps_strain) product += dot(r.V[p], G[q]) + dot(G[p], r.V[q]);
    return product;
  };
  for (int p = 0; p < 2; ++p)
    for (int q = p + 1; q < 3; ++q) {
      const Rotation2 rotation = jacobi_rotation(inner(q, q) - inner(p, p), inner(p, q));
      rotate(rotation, G[p], G[q]);
      rotate(rotation, r.V[p], r.V[q]);
    }
  Lanes norm2[3];
  for (int j = 0; j < 3; ++j) norm2[j] = inner(j, j);
  sort_columns(norm2, G, r.V);
  if constexpr (keeps_strain) {
    Column3 B[3];
    for (int j = 0; j < 3; ++j)
      for (int k = 0; k < 3; ++k) B[j][k] = r.V[j][k] + G[j][k];
    complete_svd(B, r);
    for (int i = 0; i < 3; ++i) r.e[i] = select(r.s[i] > Lanes(0.5), norm2[i] / (1.0 + r.s[i]), r.s[i] - 1.0);
  } else {
    complete_svd(G, r);
  }
  return r;
}

/// F = I + H = sum_i s_i U_i V_i^T in the plane, with proper rotations and |s_0| >= |s_1|.
struct Svd2 {
  Lanes U[2][2], V[2][2];  ///< columns
  Lanes s[2];
  Lanes e[2];  ///< s - 1, to all its digits at small strain
};

/// One rotation diagonalises F^T F, a second one on F V gives back its lost digits: reconstruction to
/// 4e-15 |F| + 1e-15 / s_0 (measured).
RESILIN_INLINE Svd2 svd2(const Lanes H[4] /* row-major */) {
  Svd2 r;
  Lanes G[2][2];  // H V
  for (int j = 0; j < 2; ++j)
    for (int i = 0; i < 2; ++i) {
      r.V[j][i] = i == j ? 1.0 : 0.0;
      G[j][i] = H[2 * i + j];
    }
  const auto inner = [&](int p, int q) {
    Lanes sum = 0.0;
    for (int i = 0; i < 2; ++i) sum += r.V[p][i] * G[q][i] + G[p][i] * r.V[q][i] + G[p][i] * G[q][i];
    return sum;
  };
  for (int sweep = 0; sweep < 2; ++sweep) {
    const Rotation2 rotation = jacobi_rotation(inner(1, 1) - inner(0, 0), inner(0, 1));
    for (auto* columns : {&r.V, &G})
      for (int i = 0; i < 2; ++i) {
        const Lanes x = (*columns)[0][i], y = (*columns)[1][i];
        (*columns)[0][i] = rotation.c * x - rotation.s * y;
        (*columns)[1][i] = rotation.s * x + rotation.c * y;
      }
  }
  Lanes norm2[2] = {inner(0, 0), inner(1, 1)};  // |F v|^2 - 1
  const Mask is_less = norm2[0] < norm2[1];
  for (auto* columns : {&r.V, &G})
    for (int i = 0; i < 2; ++i) {  // swap with a sign: stays a rotation
      const Lanes x = (*columns)[0][i], y = (*columns)[1][i];
      (*columns)[0][i] = select(is_less, y, x);
      (*columns)[1][i] = select(is_less, -x, y);
    }
  const Lanes larger = max(norm2[0], norm2[1]), smaller = min(norm2[0], norm2[1]);
  const Lanes b0 = r.V[0][0] + G[0][0], b1 = r.V[0][1] + G[0][1];
  const Lanes length2 = b0 * b0 + b1 * b1, r0 = reciprocal_sqrt(length2 + 1e-290);
  const Mask is_null = length2 < Lanes(1e-280);  // F = 0: any rotation serves
  r.U[0][0] = select(is_null, 1.0, b0 * r0);
  r.U[0][1] = select(is_null, 0.0, b1 * r0);
  r.U[1][0] = -r.U[0][1];
  r.U[1][1] = r.U[0][0];
  r.s[0] = length2 * r0;
  r.s[1] = r.U[1][0] * (r.V[1][0] + G[1][0]) + r.U[1][1] * (r.V[1][1] + G[1][1]);
  r.e[0] = select(r.s[0] > Lanes(0.5), larger / (1.0 + r.s[0]), r.s[0] - 1.0);
  r.e[1] = select(r.s[1] > Lanes(0.5), smaller / (1.0 + r.s[1]), r.s[1] - 1.0);
  return r;
}

/// The eigenvalues of a symmetric n x n matrix, on the diagonal of A on return, and its eigenvectors, the
/// columns of V: cyclic Jacobi until all lanes are diagonal to round-off, ten sweeps at most.
template <int n>
RESILIN_INLINE void diagonalize(Lanes A[n][n], Lanes V[n][n]) {
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) V[i][j] = i == j ? 1.0 : 0.0;
  for (int sweep = 0; sweep < 10; ++sweep) {
    Lanes off = 0.0, size = 0.0;
    for (int i = 0; i < n; ++i)
      for (int j = i; j < n; ++j) (i == j ? size : off) += A[i][j] * A[i][j];
    if (!any(off > 1e-32 * (size + off))) return;
    for (int p = 0; p + 1 < n; ++p)
      for (int q = p + 1; q < n; ++q) {
        const Rotation2 r = jacobi_rotation(A[q][q] - A[p][p], A[p][q]);
        for (int k = 0; k < n; ++k) {
          const Lanes x = A[k][p], y = A[k][q];
          A[k][p] = r.c * x - r.s * y;
          A[k][q] = r.s * x + r.c * y;
        }
        for (int k = 0; k < n; ++k) {
          const Lanes x = A[p][k], y = A[q][k], v = V[k][p], w = V[k][q];
          A[p][k] = r.c * x - r.s * y;
          A[q][k] = r.s * x + r.c * y;
          V[k][p] = r.c * v - r.s * w;
          V[k][q] = r.s * v + r.c * w;
        }
      }
  }
}

}  // namespace resilin::RESILIN_SIMD_NAMESPACE
