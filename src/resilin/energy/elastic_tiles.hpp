#pragma once

#include <algorithm>
#include <array>

#include "resilin/core/simd.hpp"
#include "resilin/energy/elastic.hpp"
#include "resilin/material/law_kernels.hpp"

/// How ElasticEnergy cuts its loops. For its own sources.
namespace resilin {

constexpr std::size_t blocks_per_tile = 8;     ///< what a tile holds stays in the nearest caches
constexpr std::size_t blocks_per_chunk = 256;  ///< of a parallel loop
constexpr std::size_t max_entries = 9, max_pairs = 10, max_frame_rows = 18;

/// Calls `body(begin, count)` for the tiles of [begin, end).
template <class Body>
void for_tiles(std::size_t begin, std::size_t end, const Body& body) {
  for (std::size_t i = begin; i < end; i += blocks_per_tile) body(i, std::min(blocks_per_tile, end - i));
}

/// What one tile needs.
struct ElasticEnergy::Scratch {
  template <std::size_t rows>
  using Rows = std::array<double, blocks_per_tile * rows * block_size>;
  alignas(64) Rows<max_entries> H;
  Rows<max_entries> G;
  Rows<max_variables> variables;
  Rows<max_frame_rows> frames;
  Rows<max_curvature_rows> law;
  Rows<1> energy, energy_from;
  Rows<max_constants> constants;
  alignas(64) Rows<max_pairs * max_entries> K;
  alignas(64) Rows<max_pairs * max_entries> exact_K;
};

}  // namespace resilin
