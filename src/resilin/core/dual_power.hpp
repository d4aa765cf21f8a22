#pragma once

#include "resilin/core/dual.hpp"

namespace resilin {

/// ln a of positive a; a finite number for others.
template <IsDual T>
RESILIN_DUAL_INLINE T logarithm_of_positive_part(const T& a) {
  const auto r = power_of_positive_part(a.value, 0.0 * a.value - 1.0);
  return T::chain(a, logarithm_of_positive_part(a.value), r, -(r * r));
}
/// max(a, 0)^alpha for alpha > 1. For alpha = 2 its second derivative jumps at 0; for less it has no bound
/// there.
template <IsDual T>
RESILIN_DUAL_INLINE T power_of_positive_part(const T& a, const typename T::Number& alpha) {
  const auto f1 = alpha * power_of_positive_part(a.value, alpha - 1.0);
  const auto f2 = alpha * (alpha - 1.0) * power_of_positive_part(a.value, alpha - 2.0);
  return T::chain(a, power_of_positive_part(a.value, alpha), f1, f2);
}
/// The same where both carry derivatives.
template <IsDual T>
RESILIN_DUAL_INLINE T power_of_positive_part(const T& a, const T& alpha) {
  const auto f = power_of_positive_part(a.value, alpha.value);
  const auto by_a = alpha.value * power_of_positive_part(a.value, alpha.value - 1.0);
  const auto by_alpha = f * logarithm_of_positive_part(a.value);
  T result = a.times(by_a) + alpha.times(by_alpha);
  result.value = f;
  return result;
}

}  // namespace resilin
