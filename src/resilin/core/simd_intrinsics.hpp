#pragma once

// Processor's own instructions for lanes. Apart from core/simd.hpp, because the compiler's
// header of them is long and most laws do without.

#if defined(__SSE2__)
#include <immintrin.h>
#endif

#include <cstddef>

#include "resilin/core/simd.hpp"

namespace resilin::RESILIN_SIMD_NAMESPACE {

/// Copies past the caches: for much that is written and not read again soon, so that the lines it goes to
/// need not be fetched first. `complete_streams` before another thread reads it.
RESILIN_INLINE void stream_copy(const void* from, std::size_t bytes, void* to) {
  const auto* source = static_cast<const char*>(from);
  auto* target = static_cast<char*>(to);
#if defined(__SSE2__)
  constexpr std::size_t line = 64;
  std::size_t head = -reinterpret_cast<std::size_t>(target) % line;
  if (head > bytes) head = bytes;
  __builtin_memcpy(target, source, head);  // lines that are not whole are the business of two calls
  source += head, target += head, bytes -= head;
  for (; bytes >= line; source += line, target += line, bytes -= line) {
#if defined(__AVX512F__)
    _mm512_stream_si512(reinterpret_cast<__m512i*>(target), _mm512_loadu_si512(source));
#elif defined(__AVX2__)
    for (std::size_t k = 0; k < line; k += sizeof(__m256i))
      _mm256_stream_si256(reinterpret_cast<__m256i*>(target + k),
                          _mm256_loadu_si256(reinterpret_cast<const __m256i_u*>(source + k)));
#else
    for (std::size_t k = 0; k < line; k += sizeof(__m128i))
      _mm_stream_si128(reinterpret_cast<__m128i*>(target + k),
                       _mm_loadu_si128(reinterpret_cast<const __m128i_u*>(source + k)));
#endif
  }
#endif
  __builtin_memcpy(target, source, bytes);
}

/// Makes the stores of `stream_copy` visible to other threads.
RESILIN_INLINE void complete_streams() {
#if defined(__SSE2__)
  _mm_sfence();
#endif
}

/// Whether the condition holds in at least one lane.
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

/// Square root of each lane, correctly rounded.
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
