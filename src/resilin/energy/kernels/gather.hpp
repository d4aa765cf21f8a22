#pragma once

#include "resilin/core/simd_arrays.hpp"
#include "resilin/energy/kernels/element_kernels.hpp"

/// Between lanes and the numbers of single nodes and matrix blocks.
namespace resilin::RESILIN_SIMD_NAMESPACE {

/// out[i] = component i of the nodes in these lanes. Three components are stored with stride 4, two with 2.
template <int dim>
RESILIN_INLINE void gather(const double* numbers, const std::int32_t* nodes, Lanes out[dim]) {
#if RESILIN_SIMD_WIDTH == 8
  if constexpr (dim == 3) {
    Lanes::Vector z[4];
    for (int i = 0; i < 4; ++i)
      z[i] = __builtin_shufflevector(load_four(numbers + 4L * nodes[i]),
                                     load_four(numbers + 4L * nodes[i + 4]), 0, 1, 2, 3, 4, 5, 6, 7);
    const auto a = __builtin_shufflevector(z[0], z[1], 0, 8, 2, 10, 4, 12, 6, 14);
    const auto b = __builtin_shufflevector(z[2], z[3], 0, 8, 2, 10, 4, 12, 6, 14);
    const auto c = __builtin_shufflevector(z[0], z[1], 1, 9, 3, 11, 5, 13, 7, 15);
    const auto d = __builtin_shufflevector(z[2], z[3], 1, 9, 3, 11, 5, 13, 7, 15);
    out[0] = Lanes(__builtin_shufflevector(a, b, 0, 1, 8, 9, 4, 5, 12, 13));
    out[1] = Lanes(__builtin_shufflevector(c, d, 0, 1, 8, 9, 4, 5, 12, 13));
    out[2] = Lanes(__builtin_shufflevector(a, b, 2, 3, 10, 11, 6, 7, 14, 15));
    return;
  }
#elif RESILIN_SIMD_WIDTH == 4
  if constexpr (dim == 3) {
    Four z[4];
    for (int i = 0; i < 4; ++i) z[i] = load_four(numbers + 4L * nodes[i]);
    const auto a = __builtin_shufflevector(z[0], z[1], 0, 4, 2, 6);
    const auto b = __builtin_shufflevector(z[2], z[3], 0, 4, 2, 6);
    const auto c = __builtin_shufflevector(z[0], z[1], 1, 5, 3, 7);
    const auto d = __builtin_shufflevector(z[2], z[3], 1, 5, 3, 7);
    out[0] = Lanes(__builtin_shufflevector(a, b, 0, 1, 4, 5));
    out[1] = Lanes(__builtin_shufflevector(c, d, 0, 1, 4, 5));
    out[2] = Lanes(__builtin_shufflevector(a, b, 2, 3, 6, 7));
    return;
  }
#endif
  constexpr long stride = dim == 3 ? 4 : 2;
  for (int i = 0; i < dim; ++i) {
    Lanes::Vector component = {};
    for (int lane = 0; lane < Lanes::width; ++lane) component[lane] = numbers[stride * nodes[lane] + i];
    out[i] = Lanes(component);
  }
}

RESILIN_INLINE bool owns(const OwnedNodes& owned, std::int32_t node) {
  return node >= owned.begin && node < owned.end;
}

/// Whether all lanes of the first `count` nodes are owned.
RESILIN_INLINE bool owns_all(const OwnedNodes& owned, const std::int32_t* nodes, int count) {
  std::int32_t outside = 0;  // its sign bit is set when a node is below the begin or not below the end
  for (int a = 0; a < count; ++a)
    for (int lane = 0; lane < Lanes::width; ++lane) {
      const std::int32_t node = nodes[a * block_size + lane];
      outside |= (node - owned.begin) | (owned.end - 1 - node);
    }
  return outside >= 0;
}

/// Adds component i of `values` to the nodes in these lanes, in the order of the lanes, where
/// `is_owned(node)`.
template <int dim, class IsOwned>
RESILIN_INLINE void scatter_add(const Lanes values[dim], const std::int32_t* nodes, const IsOwned& is_owned,
                                double* numbers) {
#if RESILIN_SIMD_WIDTH == 8
  if constexpr (dim == 3) {
    const Lanes::Vector zero = {};
    const auto a = __builtin_shufflevector(values[0].v, values[1].v, 0, 8, 2, 10, 4, 12, 6, 14);
    const auto b = __builtin_shufflevector(values[0].v, values[1].v, 1, 9, 3, 11, 5, 13, 7, 15);
    const auto c = __builtin_shufflevector(values[2].v, zero, 0, 8, 2, 10, 4, 12, 6, 14);
    const auto d = __builtin_shufflevector(values[2].v, zero, 1, 9, 3, 11, 5, 13, 7, 15);
    const Lanes::Vector even[2] = {__builtin_shufflevector(a, c, 0, 1, 8, 9, 2, 3, 10, 11),
                                   __builtin_shufflevector(a, c, 4, 5, 12, 13, 6, 7, 14, 15)};
    const Lanes::Vector odd[2] = {__builtin_shufflevector(b, d, 0, 1, 8, 9, 2, 3, 10, 11),
                                  __builtin_shufflevector(b, d, 4, 5, 12, 13, 6, 7, 14, 15)};
    for (int lane = 0; lane < 8; ++lane) {
      const Lanes::Vector& pair = lane % 2 == 0 ? even[lane / 4] : odd[lane / 4];
      const Four four = lane % 4 < 2 ? __builtin_shufflevector(pair, pair, 0, 1, 2, 3)
                                     : __builtin_shufflevector(pair, pair, 4, 5, 6, 7);
      if (is_owned(nodes[lane])) add_four(numbers + 4L * nodes[lane], four);
    }
    return;
  }
#endif
  constexpr long stride = dim == 3 ? 4 : 2;
  for (int lane = 0; lane < Lanes::width; ++lane)
    if (is_owned(nodes[lane]))
      for (int i = 0; i < dim; ++i) numbers[stride * nodes[lane] + i] += values[i].v[lane];
}

/// Adds the 3x3 block in each lane of rows[9][block_size] to values + 9 * slot of its lane.
RESILIN_INLINE void add_blocks3(const double* rows, const std::uint32_t* slots, const bool* is_owned,
                                double* values) {
#if RESILIN_SIMD_WIDTH == 8
  Lanes::Vector r[8];
  for (int i = 0; i < 8; ++i) r[i] = Lanes::load(rows + i * 8).v;
  transpose(r);
  for (int lane = 0; lane < 8; ++lane) {
    if (!is_owned[lane]) continue;
    double* p = values + 9L * slots[lane];
    (Lanes::load(p) + Lanes(r[lane])).store(p);
    p[8] += rows[64 + lane];
  }
#elif RESILIN_SIMD_WIDTH == 4
  for (int half = 0; half < 8; half += 4) {
    Four low[4], high[4];
    for (int i = 0; i < 4; ++i) {
      low[i] = load_four(rows + i * 8 + half);
      high[i] = load_four(rows + (i + 4) * 8 + half);
    }
    transpose(low);
    transpose(high);
    for (int lane = 0; lane < 4; ++lane) {
      if (!is_owned[half + lane]) continue;
      double* p = values + 9L * slots[half + lane];
      add_four(p, low[lane]);
      add_four(p + 4, high[lane]);
      p[8] += rows[64 + half + lane];
    }
  }
#else
  for (int lane = 0; lane < block_size; ++lane)
    if (is_owned[lane])
      for (int i = 0; i < 9; ++i) values[9L * slots[lane] + i] += rows[i * block_size + lane];
#endif
}

}  // namespace resilin::RESILIN_SIMD_NAMESPACE
