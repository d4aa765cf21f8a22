#pragma once

#include <cstddef>

#include "resilin/core/simd.hpp"

/// Between arrays of small matrices, one after the other, and rows of lanes.
namespace resilin::RESILIN_SIMD_NAMESPACE {

#if RESILIN_SIMD_WIDTH >= 4
/// Four doubles in one register.
using Four = double __attribute__((vector_size(32)));

/// Unaligned load of p[0] to p[3], and their sum with x.
RESILIN_INLINE Four load_four(const double* p) {
  Four x;
  __builtin_memcpy(&x, p, sizeof x);
  return x;
}
RESILIN_INLINE void add_four(double* p, Four x) {
  x += load_four(p);
  __builtin_memcpy(p, &x, sizeof x);
}
#endif

#if RESILIN_SIMD_WIDTH == 8
/// Rows become columns.
RESILIN_INLINE void transpose(Lanes::Vector r[8]) {
  Lanes::Vector t[8];
  for (int i = 0; i < 8; i += 2) {
    t[i] = __builtin_shufflevector(r[i], r[i + 1], 0, 8, 2, 10, 4, 12, 6, 14);
    t[i + 1] = __builtin_shufflevector(r[i], r[i + 1], 1, 9, 3, 11, 5, 13, 7, 15);
  }
  for (int i = 0; i < 2; ++i) {
    const auto a = __builtin_shufflevector(t[i], t[i + 2], 0, 1, 4, 5, 8, 9, 12, 13);
    const auto b = __builtin_shufflevector(t[i], t[i + 2], 2, 3, 6, 7, 10, 11, 14, 15);
    const auto c = __builtin_shufflevector(t[i + 4], t[i + 6], 0, 1, 4, 5, 8, 9, 12, 13);
    const auto d = __builtin_shufflevector(t[i + 4], t[i + 6], 2, 3, 6, 7, 10, 11, 14, 15);
    r[i] = __builtin_shufflevector(a, c, 0, 1, 4, 5, 8, 9, 12, 13);
    r[i + 4] = __builtin_shufflevector(a, c, 2, 3, 6, 7, 10, 11, 14, 15);
    r[i + 2] = __builtin_shufflevector(b, d, 0, 1, 4, 5, 8, 9, 12, 13);
    r[i + 6] = __builtin_shufflevector(b, d, 2, 3, 6, 7, 10, 11, 14, 15);
  }
}
#elif RESILIN_SIMD_WIDTH == 4
RESILIN_INLINE void transpose(Four r[4]) {
  const auto a = __builtin_shufflevector(r[0], r[1], 0, 4, 2, 6),
             b = __builtin_shufflevector(r[0], r[1], 1, 5, 3, 7);
  const auto c = __builtin_shufflevector(r[2], r[3], 0, 4, 2, 6),
             d = __builtin_shufflevector(r[2], r[3], 1, 5, 3, 7);
  r[0] = __builtin_shufflevector(a, c, 0, 1, 4, 5);
  r[1] = __builtin_shufflevector(b, d, 0, 1, 4, 5);
  r[2] = __builtin_shufflevector(a, c, 2, 3, 6, 7);
  r[3] = __builtin_shufflevector(b, d, 2, 3, 6, 7);
}
#endif

/// As many numbers of an array as there are lanes.
RESILIN_INLINE Lanes load_numbers(const double* p) { return Lanes::load(p); }
RESILIN_INLINE Lanes load_numbers(const float* p) {
  using Floats = float __attribute__((vector_size(sizeof(float) * Lanes::width)));
  Floats x;
  __builtin_memcpy(&x, p, sizeof x);
  return Lanes(__builtin_convertvector(x, Lanes::Vector));
}
RESILIN_INLINE void store_numbers(double* p, Lanes x) { x.store(p); }
RESILIN_INLINE void store_numbers(float* p, Lanes x) {
  using Floats = float __attribute__((vector_size(sizeof(float) * Lanes::width)));
  const Floats y = __builtin_convertvector(x.v, Floats);
  __builtin_memcpy(p, &y, sizeof y);
}

/// rows[entry][lane] = in[lane][entry] for the `count` <= block_size matrices of a block; lanes beyond repeat
/// the last one.
template <class Real>
RESILIN_INLINE void read_block(const Real* in, std::size_t count, std::size_t entries, double* rows) {
  std::size_t entry = 0;
#if RESILIN_SIMD_WIDTH >= 4
  constexpr std::size_t width = RESILIN_SIMD_WIDTH;
  for (; count == block_size && entry + width <= entries; entry += width)
    for (std::size_t first = 0; first < block_size; first += width) {
      Lanes::Vector r[width];
      for (std::size_t lane = 0; lane < width; ++lane)
        r[lane] = load_numbers(in + (first + lane) * entries + entry).v;
      transpose(r);
      for (std::size_t i = 0; i < width; ++i) Lanes(r[i]).store(rows + (entry + i) * block_size + first);
    }
#endif
  for (; entry < entries; ++entry)
    for (std::size_t lane = 0; lane < block_size; ++lane)
      rows[entry * block_size + lane] =
          static_cast<double>(in[(lane < count ? lane : count - 1) * entries + entry]);
}

/// out[lane][entry] = rows[entry][lane] for `count` <= block_size matrices.
template <class Real>
RESILIN_INLINE void write_block(const double* rows, std::size_t count, std::size_t entries, Real* out) {
  std::size_t entry = 0;
#if RESILIN_SIMD_WIDTH >= 4
  constexpr std::size_t width = RESILIN_SIMD_WIDTH;
  for (; count == block_size && entry + width <= entries; entry += width)
    for (std::size_t first = 0; first < block_size; first += width) {
      Lanes::Vector r[width];
      for (std::size_t i = 0; i < width; ++i) r[i] = Lanes::load(rows + (entry + i) * block_size + first).v;
      transpose(r);
      for (std::size_t lane = 0; lane < width; ++lane)
        store_numbers(out + (first + lane) * entries + entry, Lanes(r[lane]));
    }
#endif
  for (; entry < entries; ++entry)
    for (std::size_t lane = 0; lane < count; ++lane)
      out[lane * entries + entry] = static_cast<Real>(rows[entry * block_size + lane]);
}

}  // namespace resilin::RESILIN_SIMD_NAMESPACE
