#pragma once

#include "resilin/core/dual.hpp"

namespace resilin {

/// Invariants of the right Cauchy-Green tensor C = F^T F that vanish at rest, formed from the displacement
/// gradient H = F - I without cancellation (material/lane_variables.hpp), so that a law keeps its digits at a
/// strain of 1e-8. In 2D, plane strain: F = diag(F_2, 1).
///
/// i1, i2 and j are of first order in the strain and their first orders are 2 tr eps, 4 tr eps and tr eps; d1
/// and d2 are what is left of i1 and i2 without them, of second order. A law that is written with d1, d2 and
/// second-order functions of j (`log1p_minus`, squares) has no terms that cancel near rest.
template <class T>
struct Invariants {
  T d1;  ///< i1 - 2 j
  T d2;  ///< i2 - 4 j
  T j;   ///< J - 1
  T i1;  ///< I_C - 3
  T i2;  ///< II_C - 3, II_C = |cof F|^2

  static RESILIN_DUAL_INLINE Invariants from_reduced(const T& d1, const T& d2, const T& j) {
    return {d1, d2, j, d1 + 2.0 * j, d2 + 4.0 * j};
  }
};

/// Invariants of the small strain eps = sym H.
template <class T>
struct SmallStrain {
  T square;  ///< eps : eps
  T trace;   ///< tr eps
};

/// Limit of fibre families in a constitutive model.
constexpr int max_fibre_families = 2;

/// Invariants with the squared stretch of fibres of rest direction a, |a| = 1.
template <class T>
struct FibreInvariants : Invariants<T> {
  using Real = typename T::Number;
  T stretch[max_fibre_families];    ///< |F a|^2 - 1
  Real weight[max_fibre_families];  ///< 1 where there is such a family, else 0
};

/// The Green strain E = (F^T F - I)/2 by its components in material axes a_1, a_2, a_3, and the volume.
template <class T>
struct AxesStrain {
  T e11, e22;
  T j;  ///< J - 1
  T e33, e12, e23, e31;
};

/// The same of J^(-1/3) F. With t = J^(1/3): (E + I/2) / t^2 - I/2.
template <class T>
RESILIN_DUAL_INLINE AxesStrain<T> isochoric_strain(const AxesStrain<T>& c) {
  const T s = cbrt1p(c.j), factor = reciprocal(square(1.0 + s)), pressure = 0.5 * (s * (2.0 + s));
  return {(c.e11 - pressure) * factor,
          (c.e22 - pressure) * factor,
          c.j,
          (c.e33 - pressure) * factor,
          c.e12 * factor,
          c.e23 * factor,
          c.e31 * factor};
}

/// J^(-2/3) I_C - 3. With t = J^(1/3): d1 / t^2 + (3 + 2 j - 3 t^2) / t^2, and 2 j = 2 t^3 - 2 makes the
/// second numerator (t - 1)^2 (2 t + 1).
template <class T>
RESILIN_DUAL_INLINE T isochoric_first_invariant(const Invariants<T>& c) {
  const T s = cbrt1p(c.j);  // t - 1
  return (c.d1 + square(s) * (3.0 + 2.0 * s)) * reciprocal(square(1.0 + s));
}

/// J^(-4/3) II_C - 3. With t = J^(1/3): d2 / t^4 + (3 + 4 j - 3 t^4) / t^4, and 4 j = 4 t^3 - 4 makes the
/// second numerator -(t - 1)^2 (3 t^2 + 2 t + 1).
template <class T>
RESILIN_DUAL_INLINE T isochoric_second_invariant(const Invariants<T>& c) {
  const T s = cbrt1p(c.j);  // t - 1
  return (c.d2 - square(s) * (6.0 + s * (8.0 + 3.0 * s))) * reciprocal(square(square(1.0 + s)));
}

/// J^(-2/3) |F a|^2 - 1, of the squared stretch |F a|^2 - 1.
template <class T>
RESILIN_DUAL_INLINE T isochoric_fibre_stretch(const Invariants<T>& c, const T& stretch) {
  const T s = cbrt1p(c.j);
  return (stretch - s * (2.0 + s)) * reciprocal(square(1.0 + s));
}

}  // namespace resilin
