#pragma once

// Numbers that carry derivatives with respect to three variables, and the functions that laws are written
// with. Everything is a template on the real type (double, or the lanes of an instruction set): see
// core/simd.hpp.

#include <cmath>

namespace resilin {

/// Value and first derivatives.
template <class Real>
struct Dual {
  Real value;
  Real slope[3];

  static Dual variable(const Real& x, int index) {
    Dual result;
    result.value = x;
    for (int i = 0; i < 3; ++i) result.slope[i] = Real(i == index ? 1.0 : 0.0);
    return result;
  }
  /// f(a), with f' at a.value. (The second derivative is for Dual2.)
  static Dual chain(const Dual& a, const Real& f, const Real& f1, const Real&) {
    Dual result;
    result.value = f;
    for (int i = 0; i < 3; ++i) result.slope[i] = f1 * a.slope[i];
    return result;
  }

  friend Dual operator+(const Dual& a, const Dual& b) {
    Dual result;
    result.value = a.value + b.value;
    for (int i = 0; i < 3; ++i) result.slope[i] = a.slope[i] + b.slope[i];
    return result;
  }
  friend Dual operator*(const Dual& a, const Dual& b) {
    Dual result;
    result.value = a.value * b.value;
    for (int i = 0; i < 3; ++i) result.slope[i] = a.value * b.slope[i] + b.value * a.slope[i];
    return result;
  }
  friend Dual operator*(const Real& s, const Dual& a) { return chain(a, s * a.value, s, s); }
  friend Dual operator+(const Real& s, Dual a) {
    a.value = s + a.value;
    return a;
  }
};

/// Value, first and second derivatives (00 01 02 11 12 22).
template <class Real>
struct Dual2 {
  Real value;
  Real slope[3];
  Real curvature[6];

  static Dual2 variable(const Real& x, int index) {
    Dual2 result;
    result.value = x;
    for (int i = 0; i < 3; ++i) result.slope[i] = Real(i == index ? 1.0 : 0.0);
    for (Real& h : result.curvature) h = Real(0.0);
    return result;
  }
  /// f(a), with f' and f'' at a.value.
  static Dual2 chain(const Dual2& a, const Real& f, const Real& f1, const Real& f2) {
    Dual2 result;
    result.value = f;
    for (int i = 0, k = 0; i < 3; ++i) {
      result.slope[i] = f1 * a.slope[i];
      for (int j = i; j < 3; ++j, ++k)
        result.curvature[k] = f1 * a.curvature[k] + f2 * a.slope[i] * a.slope[j];
    }
    return result;
  }

  friend Dual2 operator+(const Dual2& a, const Dual2& b) {
    Dual2 result;
    result.value = a.value + b.value;
    for (int i = 0; i < 3; ++i) result.slope[i] = a.slope[i] + b.slope[i];
    for (int k = 0; k < 6; ++k) result.curvature[k] = a.curvature[k] + b.curvature[k];
    return result;
  }
  friend Dual2 operator*(const Dual2& a, const Dual2& b) {
    Dual2 result;
    result.value = a.value * b.value;
    for (int i = 0, k = 0; i < 3; ++i) {
      result.slope[i] = a.value * b.slope[i] + b.value * a.slope[i];
      for (int j = i; j < 3; ++j, ++k)
        result.curvature[k] = a.value * b.curvature[k] + b.value * a.curvature[k] + a.slope[i] * b.slope[j] +
                              a.slope[j] * b.slope[i];
    }
    return result;
  }
  friend Dual2 operator*(const Real& s, const Dual2& a) {
    Dual2 result;
    result.value = s * a.value;
    for (int i = 0; i < 3; ++i) result.slope[i] = s * a.slope[i];
    for (int k = 0; k < 6; ++k) result.curvature[k] = s * a.curvature[k];
    return result;
  }
  friend Dual2 operator+(const Real& s, Dual2 a) {
    a.value = s + a.value;
    return a;
  }
};

/// Kernels use only some of what a function computes, such as its slope without its value: seen in place, the
/// rest is dropped by the compiler.
#define RESILIN_DUAL_INLINE [[gnu::always_inline]] inline

/// A number with derivatives: Dual or Dual2 of some real type.
template <class T>
concept IsDual = requires(T a) {
  a.value;
  a.slope;
};

template <IsDual T>
RESILIN_DUAL_INLINE T operator-(const T& a, const T& b) {
  return a + decltype(a.value)(-1.0) * b;
}

// Functions of plain numbers. Those of lanes stand in core/simd_math.hpp.
inline double log1p(double x) { return std::log1p(x); }
/// ln(1 + x) - x without cancellation.
inline double log1p_minus(double x) {
  if (x < -0.29 || x > 0.41) return std::log1p(x) - x;
  const double s = x / (2 + x), z = s * s;  // ln(1 + x) = 2 atanh(s), 2 s - x = -x s
  double series = 0;
  for (int k = 21; k >= 3; k -= 2) series = series * z + 2.0 / k;
  return s * z * series - x * s;
}
/// (1 + x)^(1/3) - 1 without cancellation.
inline double cbrt1p(double x) {
  const double t = std::cbrt(1 + x);
  return x / (t * t + t + 1);
}

template <class T>
RESILIN_DUAL_INLINE T square(const T& a) {
  return a * a;
}

template <IsDual T>
RESILIN_DUAL_INLINE T reciprocal(const T& a) {
  const auto f = 1.0 / a.value;
  return T::chain(a, f, -f * f, 2.0 * f * f * f);
}
template <class T>
T reciprocal(const T& a) {
  return 1.0 / a;
}

template <IsDual T>
RESILIN_DUAL_INLINE T log1p(const T& a) {
  const auto slope = 1.0 / (1.0 + a.value);
  return T::chain(a, log1p(a.value), slope, -slope * slope);
}

template <IsDual T>
RESILIN_DUAL_INLINE T log1p_minus(const T& a) {
  const auto r = 1.0 / (1.0 + a.value);
  return T::chain(a, log1p_minus(a.value), -a.value * r, -r * r);
}

template <IsDual T>
RESILIN_DUAL_INLINE T cbrt1p(const T& a) {
  const auto s = cbrt1p(a.value), t = 1.0 + s;
  const auto f1 = 1.0 / (3.0 * t * t);
  return T::chain(a, s, f1, (-2.0 / 3.0) * f1 / (1.0 + a.value));
}

}  // namespace resilin
