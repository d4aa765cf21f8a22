#pragma once

// Numbers that carry derivatives with respect to some variables, and the functions that laws are written
// with. Everything is a template on the real type: the lanes of an instruction set (core/simd.hpp), or such
// numbers again, which gives derivatives with respect to a law's constants.

#include <type_traits>

namespace resilin {

/// Kernels use only some of what a function computes, such as its slope without its value: seen in place, the
/// rest is dropped by the compiler.
#define RESILIN_DUAL_INLINE inline __attribute__((always_inline))

/// Real types other than double, such as the lanes of an instruction set.
template <class Real>
concept IsNoDouble = !std::is_same_v<Real, double>;

/// Value and first derivatives with respect to n variables.
template <class Real, int n = 3>
struct Dual {
  using Number = Real;
  static constexpr int num_other = 0;

  Real value;
  Real slope[n];

  Dual() = default;
  RESILIN_DUAL_INLINE explicit Dual(double x) : value(x) {
    for (Real& s : slope) s = Real(0.0);
  }

  static RESILIN_DUAL_INLINE Dual variable(const Real& x, int index) {
    Dual result;
    result.value = x;
    for (int i = 0; i < n; ++i) result.slope[i] = Real(i == index ? 1.0 : 0.0);
    return result;
  }
  /// f(a), with f' at a.value. (The second derivative is for Dual2.)
  static RESILIN_DUAL_INLINE Dual chain(const Dual& a, const Real& f, const Real& f1, const Real&) {
    Dual result;
    result.value = f;
    for (int i = 0; i < n; ++i) result.slope[i] = f1 * a.slope[i];
    return result;
  }
  /// From a value and all its derivatives; this number keeps the first ones.
  static RESILIN_DUAL_INLINE Dual from_parts(const Real& value, const Real* slope, const Real*, const Real*) {
    Dual result;
    result.value = value;
    for (int i = 0; i < n; ++i) result.slope[i] = slope[i];
    return result;
  }

  friend RESILIN_DUAL_INLINE Dual operator+(const Dual& a, const Dual& b) {
    Dual result;
    result.value = a.value + b.value;
    for (int i = 0; i < n; ++i) result.slope[i] = a.slope[i] + b.slope[i];
    return result;
  }
  friend RESILIN_DUAL_INLINE Dual operator*(const Dual& a, const Dual& b) {
    Dual result;
    result.value = a.value * b.value;
    for (int i = 0; i < n; ++i) result.slope[i] = a.value * b.slope[i] + b.value * a.slope[i];
    return result;
  }
  template <class Factor>
  RESILIN_DUAL_INLINE Dual times(const Factor& s) const {
    Dual result;
    result.value = s * value;
    for (int i = 0; i < n; ++i) result.slope[i] = s * slope[i];
    return result;
  }
};

/// Value, first and second derivatives (00 01 02 ... 11 12 ...) with respect to n variables, and the values
/// of `more` further first-order differential operators, such as divided differences
/// (material/stretches.hpp).
template <class Real, int n = 3, int more = 0>
struct Dual2 {
  using Number = Real;
  static constexpr int num_other = more;
  static constexpr int num_curvatures = n * (n + 1) / 2;

  Real value;
  Real slope[n];
  Real curvature[num_curvatures];
  Real other[more > 0 ? more : 1];

  Dual2() = default;
  RESILIN_DUAL_INLINE explicit Dual2(double x) : value(x) {
    for (Real& s : slope) s = Real(0.0);
    for (Real& h : curvature) h = Real(0.0);
    for (int i = 0; i < more; ++i) other[i] = Real(0.0);
  }

  static RESILIN_DUAL_INLINE Dual2 variable(const Real& x, int index) {
    Dual2 result(0.0);
    result.value = x;
    result.slope[index] = Real(1.0);
    return result;
  }
  /// f(a), with f' and f'' at a.value.
  static RESILIN_DUAL_INLINE Dual2 chain(const Dual2& a, const Real& f, const Real& f1, const Real& f2) {
    Dual2 result;
    result.value = f;
    for (int i = 0, k = 0; i < n; ++i) {
      result.slope[i] = f1 * a.slope[i];
      for (int j = i; j < n; ++j, ++k)
        result.curvature[k] = f1 * a.curvature[k] + f2 * a.slope[i] * a.slope[j];
    }
    for (int i = 0; i < more; ++i) result.other[i] = f1 * a.other[i];
    return result;
  }
  static RESILIN_DUAL_INLINE Dual2 from_parts(const Real& value, const Real* slope, const Real* curvature,
                                              const Real* other) {
    Dual2 result;
    result.value = value;
    for (int i = 0; i < n; ++i) result.slope[i] = slope[i];
    for (int k = 0; k < num_curvatures; ++k) result.curvature[k] = curvature[k];
    for (int i = 0; i < more; ++i) result.other[i] = other[i];
    return result;
  }

  friend RESILIN_DUAL_INLINE Dual2 operator+(const Dual2& a, const Dual2& b) {
    Dual2 result;
    result.value = a.value + b.value;
    for (int i = 0; i < n; ++i) result.slope[i] = a.slope[i] + b.slope[i];
    for (int k = 0; k < num_curvatures; ++k) result.curvature[k] = a.curvature[k] + b.curvature[k];
    for (int i = 0; i < more; ++i) result.other[i] = a.other[i] + b.other[i];
    return result;
  }
  friend RESILIN_DUAL_INLINE Dual2 operator*(const Dual2& a, const Dual2& b) {
    Dual2 result;
    result.value = a.value * b.value;
    for (int i = 0, k = 0; i < n; ++i) {
      result.slope[i] = a.value * b.slope[i] + b.value * a.slope[i];
      for (int j = i; j < n; ++j, ++k)
        result.curvature[k] = a.value * b.curvature[k] + b.value * a.curvature[k] + a.slope[i] * b.slope[j] +
                              a.slope[j] * b.slope[i];
    }
    for (int i = 0; i < more; ++i) result.other[i] = a.value * b.other[i] + b.value * a.other[i];
    return result;
  }
  template <class Factor>
  RESILIN_DUAL_INLINE Dual2 times(const Factor& s) const {
    Dual2 result;
    result.value = s * value;
    for (int i = 0; i < n; ++i) result.slope[i] = s * slope[i];
    for (int k = 0; k < num_curvatures; ++k) result.curvature[k] = s * curvature[k];
    for (int i = 0; i < more; ++i) result.other[i] = s * other[i];
    return result;
  }
};

/// A number with derivatives: Dual or Dual2 of some real type.
template <class T>
concept IsDual = requires(T a) {
  a.value;
  a.slope;
};

// Arithmetic with the real type and with plain numbers.
template <IsDual T>
RESILIN_DUAL_INLINE T operator*(const typename T::Number& s, const T& a) {
  return a.times(s);
}
template <IsDual T>
  requires IsNoDouble<typename T::Number>
RESILIN_DUAL_INLINE T operator*(double s, const T& a) {
  return a.times(s);
}
template <IsDual T>
RESILIN_DUAL_INLINE T operator+(const typename T::Number& s, T a) {
  a.value = s + a.value;
  return a;
}
template <IsDual T>
  requires IsNoDouble<typename T::Number>
RESILIN_DUAL_INLINE T operator+(double s, T a) {
  a.value = s + a.value;
  return a;
}
template <IsDual T>
RESILIN_DUAL_INLINE T operator-(const T& a) {
  return a.times(-1.0);
}
template <IsDual T>
RESILIN_DUAL_INLINE T operator-(const T& a, const T& b) {
  return a + b.times(-1.0);
}
template <IsDual T>
RESILIN_DUAL_INLINE T operator-(double s, const T& a) {
  return s + a.times(-1.0);
}
template <IsDual T>
RESILIN_DUAL_INLINE T operator-(T a, double s) {
  a.value = a.value - s;
  return a;
}

/// a^2.
template <class T>
RESILIN_DUAL_INLINE T square(const T& a) {
  return a * a;
}

/// 1 / a.
template <IsDual T>
RESILIN_DUAL_INLINE T reciprocal(const T& a);
template <class T>
RESILIN_DUAL_INLINE T reciprocal(const T& a) {
  return 1.0 / a;
}
template <IsDual T>
RESILIN_DUAL_INLINE T operator/(double s, const T& a) {
  return reciprocal(a).times(s);
}
template <IsDual T>
RESILIN_DUAL_INLINE T operator/(const T& a, const T& b) {
  return a * reciprocal(b);
}
template <IsDual T>
RESILIN_DUAL_INLINE T reciprocal(const T& a) {
  const auto f = 1.0 / a.value, f2 = f * f;
  return T::chain(a, f, -f2, 2.0 * (f * f2));
}

/// ln(1 + a), accurate near a = 0.
template <IsDual T>
RESILIN_DUAL_INLINE T log1p(const T& a) {
  const auto slope = 1.0 / (1.0 + a.value);
  return T::chain(a, log1p(a.value), slope, -(slope * slope));
}

/// ln(1 + a) - a, accurate near a = 0.
template <IsDual T>
RESILIN_DUAL_INLINE T log1p_minus(const T& a) {
  const auto r = 1.0 / (1.0 + a.value);
  return T::chain(a, log1p_minus(a.value), -(a.value * r), -(r * r));
}

/// e^a.
template <IsDual T>
RESILIN_DUAL_INLINE T exp(const T& a) {
  const auto f = exp(a.value);
  return T::chain(a, f, f, f);
}

/// e^a - 1, accurate near a = 0.
template <IsDual T>
RESILIN_DUAL_INLINE T expm1(const T& a) {
  const auto f1 = exp(a.value);
  return T::chain(a, expm1(a.value), f1, f1);
}

/// e^a - 1 - a, accurate near a = 0.
template <IsDual T>
RESILIN_DUAL_INLINE T expm1_minus(const T& a) {
  return T::chain(a, expm1_minus(a.value), expm1(a.value), exp(a.value));
}

/// (1 + a)^(1/3) - 1, accurate near a = 0.
template <IsDual T>
RESILIN_DUAL_INLINE T cbrt1p(const T& a) {
  const auto s = cbrt1p(a.value), t = 1.0 + s;
  const auto f1 = 1.0 / (3.0 * (t * t));
  return T::chain(a, s, f1, (-2.0 / 3.0) * (f1 * (1.0 / (1.0 + a.value))));
}

/// max(a, 0)^2: its second derivative jumps at 0.
template <IsDual T>
RESILIN_DUAL_INLINE T square_of_positive_part(const T& a) {
  const auto part = positive_part(a.value);
  return T::chain(a, part * part, 2.0 * part, 2.0 * step(a.value));
}
/// max(a, 0), and its slope 0 or 1 (0 at 0).
template <IsDual T>
RESILIN_DUAL_INLINE T positive_part(const T& a) {
  return T::chain(a, positive_part(a.value), step(a.value), 0.0 * a.value);
}
template <IsDual T>
RESILIN_DUAL_INLINE T step(const T& a) {
  return T::chain(a, step(a.value), 0.0 * a.value, 0.0 * a.value);
}

}  // namespace resilin
