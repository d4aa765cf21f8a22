#include "resilin/collision/block_tree.hpp"

#include <algorithm>
#include <array>
#include <compare>
#include <cstdint>
#include <limits>
#include <utility>

#include "resilin/core/parallel.hpp"

namespace resilin {
namespace {

constexpr std::size_t blocks_per_chunk = 512;

/// Every third bit of the result is one of the 21 bits of x.
std::uint64_t spread_bits(std::uint64_t x) {
  x = (x | x << 32) & 0x1f00000000ffffULL;
  x = (x | x << 16) & 0x1f0000ff0000ffULL;
  x = (x | x << 8) & 0x100f00f00f00f00fULL;
  x = (x | x << 4) & 0x10c30c30c30c30c3ULL;
  return (x | x << 2) & 0x1249249249249249ULL;
}

/// The place of a point on the curve through the box from `low` that is `size` wide.
std::uint64_t curve_place(const std::array<double, 3>& x, const std::array<double, 3>& low, double size) {
  std::uint64_t place = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const double cell = size > 0 ? (x[i] - low[i]) / size * 2097151.0 : 0;
    place |= spread_bits(static_cast<std::uint64_t>(std::clamp(cell, 0.0, 2097151.0))) << i;
  }
  return place;
}

struct OrderedPart {
  Index body;
  std::uint64_t place;
  Index part;

  auto operator<=>(const OrderedPart&) const = default;
};

}  // namespace

BlockTree::BlockTree(std::span<const Index> vertices, int vertices_per_part, std::span<const Index> bodies,
                     std::span<const MovingPoint> points)
    : vertices_per_part_(vertices_per_part) {
  if (vertices.empty()) return;
  set_order(vertices, bodies, points);
  set_vertices(vertices);
}

void BlockTree::set_order(std::span<const Index> vertices, std::span<const Index> bodies,
                          std::span<const MovingPoint> points) {
  const auto n = static_cast<std::size_t>(vertices_per_part_);
  std::vector<std::array<double, 3>> centers(vertices.size() / n);
  std::array<double, 3> low, high;
  low.fill(std::numeric_limits<double>::infinity());
  high.fill(-std::numeric_limits<double>::infinity());
  for (std::size_t part = 0; part < centers.size(); ++part)
    for (std::size_t i = 0; i < 3; ++i) {
      double sum = 0;
      for (std::size_t k = 0; k < n; ++k)
        sum += points[static_cast<std::size_t>(vertices[part * n + k])].x[i];
      centers[part][i] = sum / static_cast<double>(n);
      low[i] = std::min(low[i], centers[part][i]);
      high[i] = std::max(high[i], centers[part][i]);
    }
  const double size = std::max({high[0] - low[0], high[1] - low[1], high[2] - low[2]});
  std::vector<OrderedPart> order(centers.size());
  for (std::size_t part = 0; part < order.size(); ++part)
    order[part] = {bodies[static_cast<std::size_t>(vertices[part * n])],
                   curve_place(centers[part], low, size), static_cast<Index>(part)};
  std::ranges::sort(order);
  std::vector<Index> bodies_of_blocks;
  for (const OrderedPart& next : order) {
    if (!bodies_of_blocks.empty() && bodies_of_blocks.back() != next.body)
      parts_.resize(bodies_of_blocks.size() * boxes_per_block, -1);
    if (parts_.size() % boxes_per_block == 0) bodies_of_blocks.push_back(next.body);
    parts_.push_back(next.part);
  }
  parts_.resize(bodies_of_blocks.size() * boxes_per_block, -1);
  set_levels(std::move(bodies_of_blocks));
}

void BlockTree::set_vertices(std::span<const Index> vertices) {
  const auto n = static_cast<std::size_t>(vertices_per_part_);
  vertices_.assign(parts_.size() * n, -1);
  for (std::size_t place = 0; place < parts_.size(); ++place) {
    if (parts_[place] < 0) continue;
    const std::size_t block = place / boxes_per_block, box = place % boxes_per_block;
    for (std::size_t k = 0; k < n; ++k)
      vertices_[(block * n + k) * boxes_per_block + box] =
          vertices[static_cast<std::size_t>(parts_[place]) * n + k];
  }
}

void BlockTree::set_levels(std::vector<Index> below) {
  level_begin_ = {0, below.size()};
  child_bodies_.assign(below.size() * boxes_per_block, -1);  // not asked for
  do {
    const std::size_t count = (below.size() + boxes_per_block - 1) / boxes_per_block;
    level_begin_.push_back(level_begin_.back() + count);
    std::vector<Index> here(count);
    for (std::size_t b = 0; b < count; ++b)
      for (std::size_t i = 0; i < boxes_per_block; ++i) {
        const std::size_t child = b * boxes_per_block + i;
        const Index body = child < below.size() ? below[child] : here[b];
        child_bodies_.push_back(body);
        here[b] = i == 0 || here[b] == body ? body : -1;
      }
    below = std::move(here);
  } while (below.size() > 1);
  blocks_.resize(level_begin_.back());
  around_.resize(level_begin_.back());
}

void BlockTree::refit(const BoxKernels& kernels, std::span<const BoxRow> vertex_rows) {
  parallel_for(num_leaf_blocks(), blocks_per_chunk, [&](std::size_t begin, std::size_t end) {
    kernels.enclose_parts(vertices_.data(), vertices_per_part_, vertex_rows.data(), begin, end,
                          blocks_.data(), around_.data());
  });
  for (std::size_t level = 1; level + 1 < level_begin_.size(); ++level) {
    const std::size_t below = level_begin_[level - 1], here = level_begin_[level];
    kernels.enclose_blocks(&around_[below], here - below, &blocks_[here], &around_[here]);
  }
}

BlockTreeView BlockTree::view() const {
  return {blocks_.data(),       level_begin_.data(), static_cast<int>(level_begin_.size()) - 1,
          child_bodies_.data(), vertices_.data(),    vertices_per_part_};
}

}  // namespace resilin
