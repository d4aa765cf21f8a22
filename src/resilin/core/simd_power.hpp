#pragma once

#include "resilin/core/simd_math.hpp"

/// Logarithms and powers of numbers that are not near 1.
namespace resilin::RESILIN_SIMD_NAMESPACE {

/// ln(1 + x)/x, and 1 at x = 0; to 4 ulp.
RESILIN_INLINE Lanes log1p_ratio(Lanes x) {
  const Mask is_zero = ~((x < Lanes(0)) | (x > Lanes(0)));
  return select(is_zero, Lanes(1.0), log1p(x) / x);
}

/// ln x, to 3 ulp.
RESILIN_INLINE Lanes logarithm(Lanes x) {
  constexpr double ln2_high = 0.693147180369123816490, ln2_low = 1.90821492927058770002e-10;
  const BinaryParts parts = binary_parts(x);
  const Lanes s = (parts.mantissa - 1.0) / (parts.mantissa + 1.0);
  return parts.exponent * ln2_high + ((s + s + atanh_tail(s)) + parts.exponent * ln2_low);
}

/// ln x of positive x; a finite number for others.
RESILIN_INLINE Lanes logarithm_of_positive_part(Lanes x) { return logarithm(max(x, Lanes(1e-300))); }
/// max(x, 0)^alpha, and 0 for x <= 0 whatever alpha is.
RESILIN_INLINE Lanes power_of_positive_part(Lanes x, Lanes alpha) {
  return select(x > Lanes(0), exp(alpha * logarithm_of_positive_part(x)), 0.0);
}

}  // namespace resilin::RESILIN_SIMD_NAMESPACE
