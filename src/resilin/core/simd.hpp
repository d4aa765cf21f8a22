#pragma once

// Lanes: a few doubles that go through the same arithmetic, one element of the mesh in each.
//
// A file that uses them is compiled once for each instruction set (cmake/ResilinKernels.cmake), which sets
// RESILIN_SIMD_NAMESPACE and RESILIN_SIMD_WIDTH. Everything stands in that namespace, is a template on
// `Lanes` or is always inlined, so that no function compiled for one processor can be linked into the code
// for another.

#include <cstdint>

#ifndef RESILIN_SIMD_NAMESPACE
#define RESILIN_SIMD_NAMESPACE baseline
#define RESILIN_SIMD_WIDTH 2
#endif
#define RESILIN_INLINE inline __attribute__((always_inline))

namespace resilin {

/// Data of elements is stored in blocks of this many, lane by lane, whatever the instruction set.
constexpr int block_size = 8;

namespace RESILIN_SIMD_NAMESPACE {

/// One double per lane; arithmetic acts lane by lane. Uninitialised by default.
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

/// a where the mask is set, else b.
RESILIN_INLINE Lanes select(Mask mask, Lanes a, Lanes b) { return Lanes(mask ? a.v : b.v); }
RESILIN_INLINE Lanes min(Lanes a, Lanes b) { return select(a < b, a, b); }
RESILIN_INLINE Lanes max(Lanes a, Lanes b) { return select(a > b, a, b); }
RESILIN_INLINE Lanes abs(Lanes a) { return select(a < Lanes(0), -a, a); }

}  // namespace RESILIN_SIMD_NAMESPACE
}  // namespace resilin
