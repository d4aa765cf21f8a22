#pragma once

#include "resilin/core/dual.hpp"

namespace resilin {

/// Arguments of a law of principal stretches: symmetric functions of e_i = s_i - 1, s_i the signed singular
/// values of F (only the smallest is negative, where det F is). In 2D, plane strain: of diag(F_2, 1), so that
/// s_3 = 1, or -1 where det F_2 < 0 and both others are longer.
///
/// T carries, besides derivatives with respect to e_1, e_2, e_3, the divided differences of the plane (i, j)
///
///   flip  (W_i - W_j) / (s_i - s_j)      twist  (W_i + W_j) / (s_i + s_j)
///
/// which are eigenvalues of d2W/dF2 (docs/theory/stretches.md). Both are first-order differential operators,
/// so they pass through sums, products and functions like slopes do; only the symmetric functions below have
/// to know theirs, and these stay exact at equal stretches. In T::other: flips by the third index, then
/// twists.
template <class T>
struct Stretches {
  using Real = typename T::Number;

  T square;  ///< sum e_i^2 = |F - R|^2
  T trace;   ///< sum e_i = tr(R^T F) - 3
  T j;       ///< J - 1
  Real e[3];

  RESILIN_DUAL_INLINE explicit Stretches(const Real shifted_stretches[3]);

  /// sum_i l_i^alpha - 3 with l_i = J^(-1/3) s_i, for J > 0.
  RESILIN_DUAL_INLINE T isochoric_power_sum(const Real& alpha) const;

  /// sum_i (ln s_i)^2, for J > 0.
  RESILIN_DUAL_INLINE T logarithm_square_sum() const;
};

namespace detail {

/// All derivatives of a symmetric function of three stretches.
template <class Real>
struct SymmetricParts {
  Real value;
  Real slope[3];
  Real curvature[6];  ///< 00 01 02 11 12 22
  Real other[6];      ///< flips 12 20 01, twists 12 20 01

  template <class T>
  RESILIN_DUAL_INLINE T as() const {
    return T::from_parts(value, slope, curvature, other);
  }
};

constexpr int next(int i) { return (i + 1) % 3; }

}  // namespace detail

template <class T>
RESILIN_DUAL_INLINE Stretches<T>::Stretches(const Real shifted_stretches[3]) {
  const Real zero(0.0), one(1.0);
  Real s[3];
  for (int i = 0; i < 3; ++i) {
    e[i] = shifted_stretches[i];
    s[i] = 1.0 + e[i];
  }
  detail::SymmetricParts<Real> q, t, d;
  q.value = e[0] * e[0] + e[1] * e[1] + e[2] * e[2];
  t.value = e[0] + e[1] + e[2];
  d.value = t.value + (e[0] * e[1] + e[1] * e[2] + e[2] * e[0]) + e[0] * e[1] * e[2];
  for (int k = 0; k < 6; ++k) {
    const bool is_diagonal = k == 0 || k == 3 || k == 5;
    q.curvature[k] = is_diagonal ? 2.0 * one : zero;
    t.curvature[k] = zero;
    d.curvature[k] = is_diagonal ? zero : k == 1 ? s[2] : k == 2 ? s[1] : s[0];
  }
  for (int k = 0; k < 3; ++k) {
    const int i = detail::next(k), j2 = detail::next(i);
    const Real twist_of_trace = 2.0 / (s[i] + s[j2]);
    q.slope[k] = 2.0 * e[k];
    t.slope[k] = one;
    d.slope[k] = s[i] * s[j2];
    q.other[k] = 2.0 * one;
    q.other[3 + k] = 2.0 - 2.0 * twist_of_trace;
    t.other[k] = zero;
    t.other[3 + k] = twist_of_trace;
    d.other[k] = -s[k];
    d.other[3 + k] = s[k];
  }
  square = q.template as<T>();
  trace = t.template as<T>();
  j = d.template as<T>();
}

/// With x_i = ln s_i - (ln J)/3 and g(x) = e^(alpha x) - 1 - alpha x the sum is sum_i g(x_i), since the x_i
/// sum to zero: no terms cancel near rest. a_i = g'(x_i) - mean g' is its slope in ln s_i.
template <class T>
RESILIN_DUAL_INLINE T Stretches<T>::isochoric_power_sum(const Real& alpha) const {
  Real y[3], s[3], inverse[3], power[3], g1[3], g2[3], a[3];
  for (int i = 0; i < 3; ++i) {
    s[i] = 1.0 + e[i];
    inverse[i] = 1.0 / s[i];
    y[i] = log1p(e[i]);
  }
  const Real mean_y = (1.0 / 3.0) * (y[0] + y[1] + y[2]);
  detail::SymmetricParts<Real> p;
  p.value = Real(0.0);
  for (int i = 0; i < 3; ++i) {
    const Real ax = alpha * (y[i] - mean_y);
    power[i] = alpha * exp(ax);
    p.value = p.value + expm1_minus(ax);
    g1[i] = alpha * expm1(ax);
    g2[i] = alpha * power[i];
  }
  const Real mean1 = (1.0 / 3.0) * (g1[0] + g1[1] + g1[2]), mean2 = (1.0 / 9.0) * (g2[0] + g2[1] + g2[2]);
  for (int i = 0; i < 3; ++i) {
    a[i] = g1[i] - mean1;
    p.slope[i] = a[i] * inverse[i];
  }
  for (int i = 0, k = 0; i < 3; ++i)
    for (int j2 = i; j2 < 3; ++j2, ++k) {
      Real h = mean2 - (1.0 / 3.0) * (g2[i] + g2[j2]);
      if (i == j2) h = h + g2[i] - a[i];
      p.curvature[k] = h * (inverse[i] * inverse[j2]);
    }
  if constexpr (T::num_other > 0) {
    for (int k = 0; k < 3; ++k) {
      const int i = detail::next(k), j2 = detail::next(i);
      // g'(x_i) - g'(x_j) = alpha e^(alpha x_j) ((s_i / s_j)^alpha - 1)
      const Real ratio = (s[i] - s[j2]) * inverse[j2];
      const Real slope = power_difference(ratio, alpha) * (power[j2] * inverse[j2]);
      const Real product = inverse[i] * inverse[j2];
      p.other[k] = 0.5 * product * (slope * (s[i] + s[j2]) - (a[i] + a[j2]));
      p.other[3 + k] = (p.slope[i] + p.slope[j2]) / (s[i] + s[j2]);
    }
  }
  return p.template as<T>();
}

/// Its slopes are 2 y_i / s_i with y_i = ln s_i. Of two of them, with s_i = s_j (1 + r), the divided
/// difference is 2 (ln(1 + r)/r - y_j) / (s_i s_j).
template <class T>
RESILIN_DUAL_INLINE T Stretches<T>::logarithm_square_sum() const {
  Real y[3], s[3], inverse[3];
  detail::SymmetricParts<Real> p;
  p.value = Real(0.0);
  for (int i = 0; i < 3; ++i) {
    s[i] = 1.0 + e[i];
    inverse[i] = 1.0 / s[i];
    y[i] = log1p(e[i]);
    p.value = p.value + y[i] * y[i];
    p.slope[i] = 2.0 * y[i] * inverse[i];
  }
  for (int i = 0, k = 0; i < 3; ++i)
    for (int j2 = i; j2 < 3; ++j2, ++k)
      p.curvature[k] = i == j2 ? 2.0 * (1.0 - y[i]) * (inverse[i] * inverse[i]) : Real(0.0);
  if constexpr (T::num_other > 0) {
    for (int k = 0; k < 3; ++k) {
      const int i = detail::next(k), j2 = detail::next(i);
      const Real ratio = (s[i] - s[j2]) * inverse[j2];
      p.other[k] = 2.0 * (log1p_ratio(ratio) - y[j2]) * (inverse[i] * inverse[j2]);
      p.other[3 + k] = (p.slope[i] + p.slope[j2]) / (s[i] + s[j2]);
    }
  }
  return p.template as<T>();
}

}  // namespace resilin
