#pragma once

// What lanes need the processor's own instructions for. Apart from core/simd.hpp, because the compiler's
// header of them is long and most laws do without.

#if defined(__SSE2__)
#include <immintrin.h>
#endif

#include "resilin/core/simd.hpp"

namespace resilin::RESILIN_SIMD_NAMESPACE {

RESILIN_INLINE bool any(Mask mask) {
#if defined(__AVX512DQ__) && RESILIN_SIMD_WIDTH == 8
  return _mm512_movepi64_mask(reinterpret_cast<__m512i>(mask)) != 0;
#elif defined(__AVX2__) && RESILIN_SIMD_WIDTH == 4
  return _mm256_movemask_pd(reinterpret_cast<__m256d>(mask)) != 0;
#else
  auto bits = mask[0];
  for (int lane = 1; lane < Lanes::width; ++lane) bits |= mask[lane];
  return bits != 0;
#endif
}

RESILIN_INLINE Lanes sqrt(Lanes a) {
#if defined(__AVX512F__) && RESILIN_SIMD_WIDTH == 8
  return Lanes(reinterpret_cast<Lanes::Vector>(_mm512_maskz_sqrt_pd(0xff, reinterpret_cast<__m512d>(a.v))));
#elif defined(__AVX2__) && RESILIN_SIMD_WIDTH == 4
  return Lanes(reinterpret_cast<Lanes::Vector>(_mm256_sqrt_pd(reinterpret_cast<__m256d>(a.v))));
#elif defined(__SSE2__) && RESILIN_SIMD_WIDTH == 2
  return Lanes(reinterpret_cast<Lanes::Vector>(_mm_sqrt_pd(reinterpret_cast<__m128d>(a.v))));
#else
  for (int lane = 0; lane < Lanes::width; ++lane) a.v[lane] = __builtin_sqrt(a.v[lane]);
  return a;
#endif
}

/// 1 / sqrt(a) for normal positive a, to about 2 ulp.
RESILIN_INLINE Lanes reciprocal_sqrt(Lanes a) {
#if defined(__AVX512F__) && RESILIN_SIMD_WIDTH == 8
  Lanes y(reinterpret_cast<Lanes::Vector>(_mm512_maskz_rsqrt14_pd(0xff, reinterpret_cast<__m512d>(a.v))));
  const Lanes half = 0.5 * a;
  y = y * (1.5 - half * y * y);  // 14 -> 27 -> 53 bits
  return y * (1.5 - half * y * y);
#else
  return 1.0 / sqrt(a);
#endif
}

}  // namespace resilin::RESILIN_SIMD_NAMESPACE
