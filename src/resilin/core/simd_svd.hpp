#pragma once

#include "resilin/core/simd.hpp"

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

struct Rotation2 {
  Lanes c, s;
};

/// The smaller rotation that diagonalises [[p, g], [g, p + d]]: (x, y) -> (c x - s y, s x + c y).
RESILIN_INLINE Rotation2 jacobi_rotation(Lanes d, Lanes g) {
  const Lanes g2 = g + g;
  const Lanes r = reciprocal_sqrt(d * d + g2 * g2 + 1e-290);
  const Lanes c2 = 0.5 + 0.5 * (abs(d) * r);  // cos^2, in [1/2, 1]
  const Lanes rc = reciprocal_sqrt(c2);
  return {c2 * rc, select(d < Lanes(0), -g, g) * (r * rc)};
}

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

/// F = sum_i s_i U_i V_i^T with proper rotations U and V, |s_0| >= |s_1| >= |s_2| and only s_2 negative where
/// det F is.
struct Svd3 {
  Column3 U[3], V[3];
  Lanes s[3];
};

/// Three two-sided sweeps on F^T F, then one one-sided sweep on F V, which gives back the digits that F^T F
/// lost: reconstruction to 2e-15 |F|, also at condition 1e6 (measured).
RESILIN_INLINE Svd3 svd(const Lanes F[9] /* row-major */) {
  Svd3 r;
  Column3 columns[3];
  for (int j = 0; j < 3; ++j) columns[j] = {{F[j], F[3 + j], F[6 + j]}};
  Symmetric3 A = {dot(columns[0], columns[0]), dot(columns[1], columns[1]), dot(columns[2], columns[2]),
                  dot(columns[0], columns[1]), dot(columns[0], columns[2]), dot(columns[1], columns[2])};
  diagonalize(A, r.V, 3);
  Column3 B[3];
  for (int j = 0; j < 3; ++j)
    for (int i = 0; i < 3; ++i)
      B[j][i] = columns[0][i] * r.V[j][0] + columns[1][i] * r.V[j][1] + columns[2][i] * r.V[j][2];
  for (int p = 0; p < 2; ++p)
    for (int q = p + 1; q < 3; ++q) {
      const Rotation2 rotation = jacobi_rotation(dot(B[q], B[q]) - dot(B[p], B[p]), dot(B[p], B[q]));
      rotate(rotation, B[p], B[q]);
      rotate(rotation, r.V[p], r.V[q]);
    }
  Lanes norm2[3];
  for (int j = 0; j < 3; ++j) norm2[j] = dot(B[j], B[j]);
  for (int p = 0; p < 2; ++p)
    for (int q = p + 1; q < 3; ++q) {  // swap with a sign: stays a rotation
      const Mask is_less = norm2[p] < norm2[q];
      const auto swap = [is_less](Lanes& a, Lanes& b, double sign) {
        const Lanes t = a;
        a = select(is_less, b, a);
        b = select(is_less, sign * t, b);
      };
      swap(norm2[p], norm2[q], 1);
      for (int k = 0; k < 3; ++k) {
        swap(B[p][k], B[q][k], -1);
        swap(r.V[p][k], r.V[q][k], -1);
      }
    }
  // U by Gram-Schmidt, so that it is a rotation also where singular values vanish.
  const Lanes r0 = reciprocal_sqrt(norm2[0] + 1e-290);
  for (int k = 0; k < 3; ++k) r.U[0][k] = B[0][k] * r0;
  const Lanes d = dot(r.U[0], B[1]);
  Column3 w;
  for (int k = 0; k < 3; ++k) w[k] = B[1][k] - d * r.U[0][k];
  const Lanes r1 = reciprocal_sqrt(dot(w, w) + 1e-290);
  for (int k = 0; k < 3; ++k) r.U[1][k] = w[k] * r1;
  r.U[2] = cross(r.U[0], r.U[1]);
  r.s[0] = norm2[0] * r0;
  r.s[1] = dot(r.U[1], B[1]);
  r.s[2] = dot(r.U[2], B[2]);
  return r;
}

}  // namespace resilin::RESILIN_SIMD_NAMESPACE
