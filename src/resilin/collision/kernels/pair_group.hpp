#pragma once

#include "resilin/collision/kernels/pair_kernels.hpp"
#include "resilin/collision/triple.hpp"
#include "resilin/core/simd_arrays.hpp"

/// Candidates in lanes.
namespace resilin::RESILIN_SIMD_NAMESPACE {

/// The places and ways of these vertices, one in each lane.
RESILIN_INLINE void load_vertices(const MovingPoint* points, const std::int32_t vertices[Lanes::width],
                                  Triple<Lanes>& x, Triple<Lanes>& p) {
#if RESILIN_SIMD_WIDTH == 8
  Lanes::Vector rows[8];
  for (int lane = 0; lane < 8; ++lane) rows[lane] = Lanes::load(points[vertices[lane]].x).v;
  transpose(rows);
  for (int i = 0; i < 3; ++i) {
    x.x[i] = Lanes(rows[i]);
    p.x[i] = Lanes(rows[4 + i]);
  }
#elif RESILIN_SIMD_WIDTH == 4
  Four places[4], ways[4];
  for (int lane = 0; lane < 4; ++lane) {
    places[lane] = load_four(points[vertices[lane]].x);
    ways[lane] = load_four(points[vertices[lane]].p);
  }
  transpose(places);
  transpose(ways);
  for (int i = 0; i < 3; ++i) {
    x.x[i] = Lanes(places[i]);
    p.x[i] = Lanes(ways[i]);
  }
#else
  for (int i = 0; i < 3; ++i)
    for (int lane = 0; lane < Lanes::width; ++lane) {
      x.x[i].v[lane] = points[vertices[lane]].x[i];
      p.x[i].v[lane] = points[vertices[lane]].p[i];
    }
#endif
}

/// The vertices of a group of candidates.
template <PairKind kind>
struct PairGroup {
  static constexpr int m = num_first(kind), n = num_second(kind);
  Triple<Lanes> x[m + n], p[m + n];

  /// Lanes beyond the last candidate repeat it.
  RESILIN_INLINE PairGroup(const PairBatch& batch, const MovingPoint* points, std::size_t begin) {
    std::int32_t vertices[m + n][Lanes::width];
    for (std::size_t lane = 0; lane < Lanes::width; ++lane) {
      const std::size_t at = begin + lane < batch.count ? begin + lane : batch.count - 1;
      const std::int32_t* first = batch.first_vertices + static_cast<std::ptrdiff_t>(batch.pairs[2 * at]) * m;
      const std::int32_t* second =
          batch.second_vertices + static_cast<std::ptrdiff_t>(batch.pairs[2 * at + 1]) * n;
      for (int i = 0; i < m; ++i) vertices[i][lane] = first[i];
      for (int j = 0; j < n; ++j) vertices[m + j][lane] = second[j];
    }
    for (int i = 0; i < m + n; ++i) load_vertices(points, vertices[i], x[i], p[i]);
  }
};

/// Stores the lanes that belong to candidates, of which there are `count`, from the one at `begin` on.
RESILIN_INLINE void store_results(Lanes values, std::size_t begin, std::size_t count, double* out) {
  if (begin + Lanes::width <= count) return values.store(out);
  double all[Lanes::width];
  values.store(all);
  for (std::size_t lane = 0; begin + lane < count; ++lane) out[lane] = all[lane];
}

}  // namespace resilin::RESILIN_SIMD_NAMESPACE
