#pragma once

// Lanes: a few doubles that go through the same arithmetic, one element of the mesh in each.
//
// A file that uses them is compiled once for each instruction set (cmake/ResilinKernels.cmake), which sets
// RESILIN_SIMD_NAMESPACE and RESILIN_SIMD_WIDTH. Everything stands in that namespace, is a template on
// `Lanes` or is always inlined, so that no function compiled for one processor can be linked into the code
// for another.

#include <cstdint>
#if defined(__SSE2__)
#include <immintrin.h>
#endif

#ifndef RESILIN_SIMD_NAMESPACE
#define RESILIN_SIMD_NAMESPACE baseline
#define RESILIN_SIMD_WIDTH 2
#endif
#define RESILIN_INLINE inline __attribute__((always_inline))

namespace resilin {

/// Data of elements is stored in blocks of this many, lane by lane, whatever the instruction set.
constexpr int block_size = 8;

namespace RESILIN_SIMD_NAMESPACE {

struct Lanes {
  static constexpr int width = RESILIN_SIMD_WIDTH;
  using Vector = double __attribute__((vector_size(sizeof(double) * width), may_alias));
  using Mask = decltype(Vector{} < Vector{});  ///< all bits of a lane set where true

  Vector v;

  Lanes() = default;
  RESILIN_INLINE Lanes(double x) : v(x - Vector{}) {}
  RESILIN_INLINE explicit Lanes(Vector vector) : v(vector) {}

  static RESILIN_INLINE Lanes load(const double* p) {
    Lanes x;
    __builtin_memcpy(&x.v, p, sizeof(Vector));
    return x;
  }
  RESILIN_INLINE void store(double* p) const { __builtin_memcpy(p, &v, sizeof(Vector)); }

  friend RESILIN_INLINE Lanes operator+(Lanes a, Lanes b) { return Lanes(a.v + b.v); }
  friend RESILIN_INLINE Lanes operator-(Lanes a, Lanes b) { return Lanes(a.v - b.v); }
  friend RESILIN_INLINE Lanes operator*(Lanes a, Lanes b) { return Lanes(a.v * b.v); }
  friend RESILIN_INLINE Lanes operator/(Lanes a, Lanes b) { return Lanes(a.v / b.v); }
  friend RESILIN_INLINE Lanes operator-(Lanes a) { return Lanes(-a.v); }
  RESILIN_INLINE Lanes& operator+=(Lanes b) { return *this = *this + b; }
  RESILIN_INLINE Lanes& operator-=(Lanes b) { return *this = *this - b; }
  RESILIN_INLINE Lanes& operator*=(Lanes b) { return *this = *this * b; }
  friend RESILIN_INLINE Mask operator<(Lanes a, Lanes b) { return a.v < b.v; }
  friend RESILIN_INLINE Mask operator>(Lanes a, Lanes b) { return a.v > b.v; }
};
using Mask = Lanes::Mask;

RESILIN_INLINE Lanes select(Mask mask, Lanes a, Lanes b) { return Lanes(mask ? a.v : b.v); }
RESILIN_INLINE Lanes min(Lanes a, Lanes b) { return select(a < b, a, b); }
RESILIN_INLINE Lanes max(Lanes a, Lanes b) { return select(a > b, a, b); }
RESILIN_INLINE Lanes abs(Lanes a) { return select(a < Lanes(0), -a, a); }
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

}  // namespace RESILIN_SIMD_NAMESPACE
}  // namespace resilin
