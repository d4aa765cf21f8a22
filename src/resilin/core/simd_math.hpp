#pragma once

#include "resilin/core/simd.hpp"

/// Logarithms, exponentials and roots of lanes, for arguments inside their domain: positive normal numbers
/// under the logarithm and the root. Elsewhere the result means nothing; callers mask it. An ulp is the
/// distance of the doubles at the result; the bounds are measured.
namespace resilin::RESILIN_SIMD_NAMESPACE {

/// x = mantissa 2^exponent with the mantissa in [sqrt(1/2), sqrt(2)).
struct BinaryParts {
  Lanes mantissa, exponent;
};

/// Splits x; meaningless outside the domain.
RESILIN_INLINE BinaryParts binary_parts(Lanes x) {
  using Bits =
      unsigned long long __attribute__((vector_size(sizeof(Mask))));  // wraps around outside the domain
  BinaryParts parts;
  Bits bits;
  __builtin_memcpy(&bits, &x.v, sizeof bits);
  const Bits above = bits - 0x3fe6a09e667f3bcdULL;  // the bits of sqrt(1/2)
  const Mask exponent = reinterpret_cast<Mask>(above) >> 52;
  bits -= reinterpret_cast<Bits>(exponent) << 52;
  __builtin_memcpy(&parts.mantissa.v, &bits, sizeof bits);
  // An integer below 2^51 becomes a double by adding it to the bits of 1.5 * 2^52.
  const Mask shifted = exponent + 0x4338000000000000LL;
  __builtin_memcpy(&parts.exponent.v, &shifted, sizeof shifted);
  parts.exponent -= 6755399441055744.0;
  return parts;
}

/// 2 atanh(s) = 2 s + tail for |s| <= 0.172, s = (m - 1) / (m + 1): the series, cut below 1e-18.
RESILIN_INLINE Lanes atanh_tail(Lanes s) {
  const Lanes z = s * s;
  Lanes p = 2.0 / 21;
  p = p * z + 2.0 / 19;
  p = p * z + 2.0 / 17;
  p = p * z + 2.0 / 15;
  p = p * z + 2.0 / 13;
  p = p * z + 2.0 / 11;
  p = p * z + 2.0 / 9;
  p = p * z + 2.0 / 7;
  p = p * z + 2.0 / 5;
  p = p * z + 2.0 / 3;
  return s * (z * p);
}

/// Logarithm of 1 + x, and the same without its linear term.
struct LogarithmPair {
  Lanes log1p;        ///< ln(1 + x), to 3 ulp
  Lanes log1p_minus;  ///< ln(1 + x) - x, to 4 ulp for |x| < 0.29 and 24 beyond
};

/// Both logarithms of `LogarithmPair` at once.
RESILIN_INLINE LogarithmPair logarithm_pair(Lanes x) {
  constexpr double ln2_high = 0.693147180369123816490, ln2_low = 1.90821492927058770002e-10;
  const BinaryParts parts = binary_parts(1.0 + x);
  const Mask is_scaled = (parts.exponent > Lanes(0)) | (parts.exponent < Lanes(0));
  const Lanes y = select(is_scaled, parts.mantissa - 1.0, x);  // 1 + x is rounded, x is not
  const Lanes s = y / (y + 2.0);
  const Lanes tail = atanh_tail(s);
  const Lanes log = parts.exponent * ln2_high + ((s + s + tail) + parts.exponent * ln2_low);
  return {log, select(is_scaled, log - x, tail - x * s)};  // 2 s - x = -x s
}

/// One member of `LogarithmPair`.
RESILIN_INLINE Lanes log1p(Lanes x) { return logarithm_pair(x).log1p; }
RESILIN_INLINE Lanes log1p_minus(Lanes x) { return logarithm_pair(x).log1p_minus; }

/// 2^n for whole numbers -1022 <= n <= 1023.
RESILIN_INLINE Lanes power_of_two(Lanes n) {
  Mask bits;
  const Lanes shifted = n + 6755399441055744.0;
  __builtin_memcpy(&bits, &shifted.v, sizeof bits);
  bits = (bits - 0x4338000000000000LL + 1023) << 52;
  Lanes power;
  __builtin_memcpy(&power.v, &bits, sizeof bits);
  return power;
}

/// (1 + x)^(1/3) - 1, to 6 ulp.
RESILIN_INLINE Lanes cbrt1p(Lanes x) {
  const BinaryParts parts = binary_parts(1.0 + x);
  constexpr double round = 6755399441055744.0;  // adding and subtracting it rounds to an integer
  const Lanes third = (parts.exponent * (1.0 / 3.0) + round) - round;
  const Lanes rest = parts.exponent - 3.0 * third;  // -1, 0 or 1
  const Lanes a = parts.mantissa * select(rest > Lanes(0), 2.0, select(rest < Lanes(0), 0.5, 1.0));
  Lanes y = 0.6 + 0.4 * a;                // within 23 % for a in [0.35, 2.83]
  for (int step = 0; step < 3; ++step) {  // Halley: 8e-3, 4e-7, 1e-16
    const Lanes cube = y * y * y;
    y = y * (cube + 2.0 * a) / (2.0 * cube + a);
  }
  const Lanes t = y * power_of_two(third);
  return x / (t * t + t + 1.0);
}

/// e^x, and the same without its constant and linear terms.
struct Exponentials {
  Lanes exp;          ///< e^x, to 1 ulp
  Lanes expm1;        ///< e^x - 1, to 2 ulp
  Lanes expm1_minus;  ///< e^x - 1 - x, to 9 ulp
};

/// e^x is +infinity above 709.78 and e^-708 below -708. A number that is none stays none.
RESILIN_INLINE Exponentials exponentials(Lanes x) {
  constexpr double ln2_high = 0.693147180369123816490, ln2_low = 1.90821492927058770002e-10;
  constexpr double round = 6755399441055744.0;  // adding and subtracting it rounds to an integer
  const Lanes y = min(max(x, Lanes(-708.0)), Lanes(709.78));
  const Lanes n = (y * 1.4426950408889634 + round) - round;
  const Lanes r = (y - n * ln2_high) - n * ln2_low;  // |r| <= ln 2 / 2: the series below is cut at 1e-18
  Lanes p = 1.0 / 1307674368000.0;
  p = p * r + 1.0 / 87178291200.0;
  p = p * r + 1.0 / 6227020800.0;
  p = p * r + 1.0 / 479001600.0;
  p = p * r + 1.0 / 39916800.0;
  p = p * r + 1.0 / 3628800.0;
  p = p * r + 1.0 / 362880.0;
  p = p * r + 1.0 / 40320.0;
  p = p * r + 1.0 / 5040.0;
  p = p * r + 1.0 / 720.0;
  p = p * r + 1.0 / 120.0;
  p = p * r + 1.0 / 24.0;
  p = p * r + 1.0 / 6.0;
  p = p * r + 0.5;
  const Lanes tail = r * r * p;
  const Mask is_scaled = (n > Lanes(0)) | (n < Lanes(0));
  const Lanes half = power_of_two(n - 1.0);  // 2^1024 would not fit
  const Lanes scaled = (half * (r + tail) + (half - 0.5)) * 2.0;
  const Mask is_huge = x > Lanes(709.78), is_none = ~((x < Lanes(0)) | (x > Lanes(0)) | (x > Lanes(-1)));
  Lanes expm1 = select(is_scaled, scaled, r + tail);
  expm1 = select(is_huge, __builtin_inf(), select(is_none, x, expm1));
  const Lanes exp = select(is_huge | is_none, expm1, half * (1.0 + (r + tail)) * 2.0);
  return {exp, expm1, select(is_scaled | is_huge | is_none, expm1 - x, tail)};
}

/// One member of `Exponentials`.
RESILIN_INLINE Lanes expm1(Lanes x) { return exponentials(x).expm1; }
RESILIN_INLINE Lanes expm1_minus(Lanes x) { return exponentials(x).expm1_minus; }
RESILIN_INLINE Lanes exp(Lanes x) { return exponentials(x).exp; }

/// ((1 + x)^alpha - 1) / x, and alpha at x = 0; to 6 (1 + |alpha ln(1 + x)|) ulp.
RESILIN_INLINE Lanes power_difference(Lanes x, Lanes alpha) {
  const Mask is_zero = ~((x < Lanes(0)) | (x > Lanes(0)));
  return select(is_zero, alpha, expm1(alpha * log1p(x)) / x);
}

/// max(x, 0).
RESILIN_INLINE Lanes positive_part(Lanes x) { return max(x, Lanes(0.0)); }
/// 1 above zero, else 0.
RESILIN_INLINE Lanes step(Lanes x) { return select(x > Lanes(0), 1.0, 0.0); }

}  // namespace resilin::RESILIN_SIMD_NAMESPACE
