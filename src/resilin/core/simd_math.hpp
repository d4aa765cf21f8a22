#pragma once

#include "resilin/core/simd.hpp"

/// Logarithms and roots of lanes, for arguments inside their domain: positive normal numbers under the
/// logarithm and the root. Elsewhere the result means nothing; callers mask it.
namespace resilin::RESILIN_SIMD_NAMESPACE {

/// x = mantissa 2^exponent with the mantissa in [sqrt(1/2), sqrt(2)).
struct BinaryParts {
  Lanes mantissa, exponent;
};

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

struct LogarithmPair {
  Lanes log1p;        ///< ln(1 + x)
  Lanes log1p_minus;  ///< ln(1 + x) - x, without cancellation
};

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

RESILIN_INLINE Lanes log1p(Lanes x) { return logarithm_pair(x).log1p; }
RESILIN_INLINE Lanes log1p_minus(Lanes x) { return logarithm_pair(x).log1p_minus; }

/// (1 + x)^(1/3) - 1, without cancellation.
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
  Mask bits;  // 2^third
  const Lanes shifted = third + round;
  __builtin_memcpy(&bits, &shifted.v, sizeof bits);
  bits = (bits - 0x4338000000000000LL + 1023) << 52;
  Lanes scale;
  __builtin_memcpy(&scale.v, &bits, sizeof bits);
  const Lanes t = y * scale;
  return x / (t * t + t + 1.0);
}

}  // namespace resilin::RESILIN_SIMD_NAMESPACE
