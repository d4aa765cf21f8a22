#pragma once

#include <stdint.h>

#include "resilin/core/instruction_set.hpp"

/// Rows of small blocks in lanes of float, and numbers of two bytes with a scale. For kernels, under the rule
/// of block_kernels.cpp; each instruction set has its own.
#define RESILIN_INLINE inline __attribute__((always_inline))

namespace resilin::RESILIN_SIMD_NAMESPACE {

constexpr int lanes_of(int size) { return size <= 2 ? 2 : size <= 4 ? 4 : 8; }

template <int lanes>
struct FloatLanes {
  typedef float type __attribute__((vector_size(sizeof(float) * lanes)));
  typedef float loadable
      __attribute__((vector_size(sizeof(float) * lanes), aligned(sizeof(float)), may_alias));
};

template <int lanes>
using Lane = typename FloatLanes<lanes>::type;

template <int lanes>
RESILIN_INLINE Lane<lanes> load(const float* from) {
  return *reinterpret_cast<const typename FloatLanes<lanes>::loadable*>(from);
}

template <int lanes>
struct ShortLanes {
  typedef int32_t whole __attribute__((vector_size(sizeof(int32_t) * lanes)));
  typedef int16_t loadable
      __attribute__((vector_size(sizeof(int16_t) * lanes), aligned(sizeof(int16_t)), may_alias));
};

/// Numbers of two bytes, their scale apart.
template <int lanes>
RESILIN_INLINE Lane<lanes> load(const int16_t* from) {
  return __builtin_convertvector(*reinterpret_cast<const typename ShortLanes<lanes>::loadable*>(from),
                                 Lane<lanes>);
}

template <int lanes>
RESILIN_INLINE void store(float* to, Lane<lanes> value) {
  *reinterpret_cast<typename FloatLanes<lanes>::loadable*>(to) = value;
}

/// A row of a block, which has no padding.
template <int size>
RESILIN_INLINE void store_row(float* to, Lane<lanes_of(size)> row) {
  if constexpr (size == 6) {  // a copy of six numbers would go through memory
    store<4>(to, __builtin_shufflevector(row, row, 0, 1, 2, 3));
    store<2>(to + 4, __builtin_shufflevector(row, row, 4, 5));
  } else {
    __builtin_memcpy(to, &row, size * sizeof(float));
  }
}

/// Sum of the lanes that have a meaning.
template <int size>
RESILIN_INLINE float sum_of(Lane<lanes_of(size)> value) {
  float sum = value[0];
  for (int k = 1; k < size; ++k) sum += value[k];
  return sum;
}

/// The largest number becomes the largest that two bytes hold.
RESILIN_INLINE float shorten(const float* numbers, int64_t count, int16_t* to) {
  constexpr int lanes = 8;
  constexpr float most = 32767, tiny = 1e-30F;  // bounds of numbers whose inverse is a number
  Lane<lanes> sizes = {}, rest = {};            // `rest` stays zero unless some are no numbers
  const int64_t whole = count / lanes * lanes;
  for (int64_t k = 0; k < whole; k += lanes) {
    const Lane<lanes> v = load<lanes>(numbers + k), size = v < 0 ? -v : v;
    sizes = size > sizes ? size : sizes;
    rest += v - v;
  }
  float largest = 0, all_rest = 0;
  const auto look_at = [&](float size, float more) {
    largest = size > largest ? size : largest;
    all_rest += more;
  };
  for (int lane = 0; lane < lanes; ++lane) look_at(sizes[lane], rest[lane]);
  for (int64_t k = whole; k < count; ++k) look_at(__builtin_fabsf(numbers[k]), numbers[k] - numbers[k]);
  if (all_rest != 0 || largest < tiny) {
    for (int64_t k = 0; k < count; ++k) to[k] = 0;
    return all_rest;
  }
  const float inverse = most / largest;
  for (int64_t k = 0; k < whole; k += lanes) {
    const Lane<lanes> v = load<lanes>(numbers + k) * inverse;
    const Lane<lanes> away = v < 0 ? Lane<lanes>{} - 0.5F : Lane<lanes>{} + 0.5F;  // from zero
    const auto rounded = __builtin_convertvector(v + away, typename ShortLanes<lanes>::whole);
    *reinterpret_cast<typename ShortLanes<lanes>::loadable*>(to + k) =
        __builtin_convertvector(rounded, typename ShortLanes<lanes>::loadable);
  }
  for (int64_t k = whole; k < count; ++k) {
    const float v = numbers[k] * inverse;
    to[k] = int16_t(int32_t(v + (v < 0 ? -0.5F : 0.5F)));
  }
  return largest / most;
}

}  // namespace resilin::RESILIN_SIMD_NAMESPACE
