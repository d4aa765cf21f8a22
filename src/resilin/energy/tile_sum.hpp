#pragma once

#include <limits>
#include <span>

#include "resilin/core/parallel.hpp"
#include "resilin/core/simd.hpp"
#include "resilin/energy/elastic_tiles.hpp"

namespace resilin {

/// Sum of the lanes and their compensations, in a fixed order.
struct LaneSum {
  EnergySum lanes;
  LaneSum& operator+=(const LaneSum& other) {
    for (std::size_t i = 0; i < block_size; ++i) {
      const double next = lanes.sum[i] + other.lanes.sum[i], shown = next - lanes.sum[i];
      lanes.rest[i] += (lanes.sum[i] - (next - shown)) + (other.lanes.sum[i] - shown) + other.lanes.rest[i];
      lanes.sum[i] = next;
    }
    lanes.is_outside = lanes.is_outside || other.lanes.is_outside;
    return *this;
  }
  double total() const {
    if (lanes.is_outside) return std::numeric_limits<double>::infinity();
    double sum = 0, rest = 0;
    for (std::size_t i = 0; i < block_size; ++i) {
      const double next = sum + lanes.sum[i], shown = next - sum;
      rest += (sum - (next - shown)) + (lanes.sum[i] - shown) + lanes.rest[i];
      sum = next;
    }
    return sum + rest;
  }
};

/// Sum of what `add(tile, scratch, sum)` adds for the tiles of these blocks; +infinity outside the domain.
template <class AddTile>
double sum_of_tiles(const ElasticTiles& tiles, std::span<const Index> blocks, const AddTile& add) {
  return parallel_sum<LaneSum>(blocks.size(), blocks_per_chunk,
                               [&](std::size_t begin, std::size_t end) {
                                 LaneSum sum;
                                 ElasticTiles::Scratch scratch(tiles);
                                 for_tiles(
                                     tiles, blocks.data() + begin, end - begin,
                                     [&](const ElasticTiles::Tile& tile) { add(tile, scratch, sum.lanes); });
                                 return sum;
                               })
      .total();
}

}  // namespace resilin
