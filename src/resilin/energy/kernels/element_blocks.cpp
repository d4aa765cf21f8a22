#include "resilin/energy/kernels/element_blocks.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "resilin/core/error.hpp"
#include "resilin/core/memory.hpp"
#include "resilin/core/parallel.hpp"
#include "resilin/core/simd.hpp"
#include "resilin/core/text.hpp"
#include "resilin/element/axisymmetric.hpp"

namespace resilin {
namespace {

constexpr std::size_t nodes_per_chunk = 2048, lanes_per_chunk = 1024;

/// Interleaves the bits of up to three coordinates of 21 bits: position on the Morton curve.
std::uint64_t morton_key(const std::array<std::uint32_t, 3>& coordinates) {
  std::uint64_t key = 0;
  for (int bit = 20; bit >= 0; --bit)
    for (const std::uint32_t c : coordinates) key = key << 1 | (c >> bit & 1u);
  return key;
}

std::vector<Index> used_nodes(std::span<const Index> cells, Index num_world_nodes) {
  if (cells.empty()) return {};
  const auto [lowest, highest] = std::ranges::minmax(cells);
  if (lowest < 0 || highest >= num_world_nodes)
    throw InputError("cells", "node numbers in [0, " + std::to_string(num_world_nodes) + ")",
                     std::to_string(lowest < 0 ? lowest : highest));
  std::vector<bool> is_used(static_cast<std::size_t>(num_world_nodes), false);
  for (const Index node : cells) is_used[static_cast<std::size_t>(node)] = true;
  std::vector<Index> nodes;
  nodes.reserve(static_cast<std::size_t>(std::ranges::count(is_used, true)));
  for (Index node = lowest; node <= highest; ++node)
    if (is_used[static_cast<std::size_t>(node)]) nodes.push_back(node);
  return nodes;
}

/// Sorts nodes along the Morton curve, so that nodes that are near in space are near in memory.
void sort_in_space(std::vector<Index>& nodes, int dim, const VectorX& positions) {
  Vector3 low = Vector3::Constant(std::numeric_limits<double>::infinity()), high = -low;
  const auto position = [&](Index node) {
    Vector3 p = Vector3::Zero();
    for (int i = 0; i < dim; ++i) p[i] = positions[Eigen::Index{dim} * node + i];
    return p;
  };
  for (const Index node : nodes) {
    low = low.cwiseMin(position(node));
    high = high.cwiseMax(position(node));
  }
  const double extent = nodes.empty() ? 1 : (high - low).maxCoeff();
  const double scale = extent > 0 ? 2097151.0 / extent : 0;
  std::vector<std::pair<std::uint64_t, Index>> keys;
  keys.reserve(nodes.size());
  for (const Index node : nodes) {
    const Vector3 p = (position(node) - low) * scale;
    keys.emplace_back(morton_key({static_cast<std::uint32_t>(p[0]), static_cast<std::uint32_t>(p[1]),
                                  static_cast<std::uint32_t>(p[2])}),
                      node);
  }
  parallel_sort(keys, std::less<>());
  for (std::size_t i = 0; i < keys.size(); ++i) nodes[i] = keys[i].second;
}

/// Whether the nodes of a cell have near numbers as it is, like those of a grid that is numbered plane by
/// plane.
bool are_in_order(std::span<const Index> cells, const ElementInfo& element, std::size_t num_used_nodes) {
  const auto n = static_cast<std::size_t>(element.num_nodes);
  double sum_of_spans = 0;
  for (std::size_t first = 0; first + n <= cells.size(); first += n) {
    const auto [low, high] = std::ranges::minmax(cells.subspan(first, n));
    sum_of_spans += high - low;
  }
  const double plane = std::pow(static_cast<double>(num_used_nodes), 1 - 1.0 / element.dim);
  return sum_of_spans * static_cast<double>(n) <= 2 * plane * static_cast<double>(cells.size());
}

/// Local nodes of every cell, in the cell's own order.
std::vector<Index> local_cells(std::span<const Index> cells, const std::vector<Index>& world_nodes) {
  std::vector<Index> local(
      world_nodes.empty() ? 0 : static_cast<std::size_t>(*std::ranges::max_element(world_nodes)) + 1);
  for (std::size_t i = 0; i < world_nodes.size(); ++i)
    local[static_cast<std::size_t>(world_nodes[i])] = static_cast<Index>(i);
  std::vector<Index> result(cells.size());
  for (std::size_t i = 0; i < cells.size(); ++i) result[i] = local[static_cast<std::size_t>(cells[i])];
  return result;
}

/// Order of the cells: by their local nodes, sorted.
std::vector<Index> sorted_cells(const std::vector<Index>& cells, int num_nodes) {
  const auto n = static_cast<std::size_t>(num_nodes);
  std::vector<Index> keys = cells;
  const std::size_t num_cells = cells.size() / n;
  parallel_for(num_cells, lanes_per_chunk, [&](std::size_t first, std::size_t last) {
    for (std::size_t c = first; c < last; ++c)
      std::sort(keys.begin() + static_cast<std::ptrdiff_t>(c * n),
                keys.begin() + static_cast<std::ptrdiff_t>((c + 1) * n));
  });
  std::vector<Index> order(num_cells);
  std::iota(order.begin(), order.end(), 0);
  parallel_sort(order, [&](Index a, Index b) {
    const Index* ka = keys.data() + static_cast<std::size_t>(a) * n;
    const Index* kb = keys.data() + static_cast<std::size_t>(b) * n;
    for (std::size_t i = 0; i < n; ++i)
      if (ka[i] != kb[i]) return ka[i] < kb[i];
    return a < b;
  });
  return order;
}

/// Puts cells that follow one another into one lane of the blocks of a run, not side by side: neighbours
/// share nodes, and additions to the same place one right after the other wait for each other. -1 where a
/// lane stays empty.
std::vector<Index> spread_over_blocks(const std::vector<Index>& order) {
  constexpr std::size_t blocks_per_run = 8;
  const std::size_t num_blocks = (order.size() + block_size - 1) / block_size;
  std::vector<Index> lanes(num_blocks * block_size, -1);
  for (std::size_t first = 0, next = 0; first < num_blocks; first += blocks_per_run) {
    const std::size_t count = std::min(blocks_per_run, num_blocks - first);
    for (std::size_t lane = 0; lane < block_size; ++lane)
      for (std::size_t block = first; block < first + count && next < order.size(); ++block)
        lanes[block * block_size + lane] = order[next++];
  }
  return lanes;
}

/// Whether the cells take the kernels of linear simplices.
bool are_linear_simplices(const ElementInfo& element, const ElementBlocks& blocks) {
  return blocks.is_linear_simplex() && !is_axisymmetric(element);
}

/// Rows of `ElementBlocks::gradients` for each point: dxi/dX, and 1/R in axisymmetric solids.
std::size_t rows_of_point(const ElementInfo& element) {
  return static_cast<std::size_t>(element.dim * element.dim) + (is_axisymmetric(element) ? 1 : 0);
}

void check_volumes(const ElementBlocks& blocks) {
  const std::size_t of_block = blocks.num_points * block_size;
  for (std::size_t i = 0; i < blocks.weights.size(); ++i) {
    const Index cell = blocks.cells[i / of_block * block_size + i % block_size];
    if (cell < 0 || (blocks.weights[i] > 0 && std::isfinite(blocks.weights[i]))) continue;
    throw InputError("cell " + std::to_string(cell), "a positive volume", format_number(blocks.weights[i]),
                     "number its nodes the other way round, or remove it");
  }
}

/// Writes geometry and nodes of a cell into a lane.
void fill_lane(const ElementInfo& element, const QuadratureRule& rule, std::span<const Index> cell,
               std::span<const Index> local_cell, bool is_copy, std::size_t block, std::size_t lane,
               const VectorX& X, ElementBlocks& out) {
  const auto n = static_cast<std::size_t>(element.num_nodes), dim = static_cast<std::size_t>(element.dim);
  std::vector<std::size_t> order(n);
  std::iota(order.begin(), order.end(), std::size_t{0});
  if (are_linear_simplices(element, out))
    std::ranges::sort(order, [&](std::size_t a, std::size_t b) { return cell[a] < cell[b]; });
  for (std::size_t a = 0; a < n; ++a) out.nodes[(block * n + a) * block_size + lane] = local_cell[order[a]];

  std::vector<double> positions(n * dim);
  for (std::size_t a = 0; a < n; ++a)
    for (std::size_t i = 0; i < dim; ++i)
      positions[a * dim + i] = X[static_cast<Eigen::Index>(static_cast<std::size_t>(cell[a]) * dim + i)];
  const std::size_t num_points = rule.points.size(), rows = rows_of_point(element);
  for (std::size_t q = 0; q < num_points; ++q) {
    const PointGeometry geometry = point_geometry(element, rule.points[q], positions);
    out.weights[(block * num_points + q) * block_size + lane] = is_copy ? 0 : geometry.weight;
    for (std::size_t k = 0; k < dim * dim && !are_linear_simplices(element, out); ++k)
      out.gradients[((block * num_points + q) * rows + k) * block_size + lane] =
          is_copy ? 0
                  : geometry.dxi_dX(static_cast<Eigen::Index>(k / dim), static_cast<Eigen::Index>(k % dim));
    if (!is_axisymmetric(element) || is_copy) continue;
    std::vector<double> N(n);
    element.shape_values(rule.points[q].xi, N);
    double R = 0;
    for (std::size_t a = 0; a < n; ++a) R += N[a] * positions[a * dim];
    out.gradients[((block * num_points + q) * rows + dim * dim) * block_size + lane] = 1 / R;
  }
}

/// dN_a/dxi_k and N_a at [point][a], for axisymmetric solids.
std::vector<double> reference_gradients_and_values(const ElementInfo& element, const QuadratureRule& rule) {
  const auto n = static_cast<std::size_t>(element.num_nodes);
  std::vector<double> gradients(2 * n), values(n), all;
  for (const QuadraturePoint& point : rule.points) {
    element.shape_gradients(point.xi, gradients);
    element.shape_values(point.xi, values);
    for (std::size_t a = 0; a < n; ++a)
      all.insert(all.end(), {gradients[2 * a], gradients[2 * a + 1], values[a]});
  }
  return all;
}

/// dN_a/dxi_k at [point][a][k].
std::vector<double> reference_gradients(const ElementInfo& element, const QuadratureRule& rule) {
  const auto size = static_cast<std::size_t>(element.num_nodes * element.dim);
  std::vector<double> all(size * rule.points.size());
  for (std::size_t q = 0; q < rule.points.size(); ++q)
    element.shape_gradients(rule.points[q].xi, std::span(all).subspan(q * size, size));
  return all;
}

/// Throws OutOfMemory where the numbers of so many cells do not fit.
void foresee_geometry(const ElementInfo& element, const QuadratureRule& rule, std::size_t num_cells) {
  const auto n = static_cast<double>(element.num_nodes), dim = static_cast<double>(element.dim);
  const double of_points = static_cast<double>(rule.points.size()) * (dim * dim + 1) * sizeof(double);
  const double of_slots = n * (n + 1) / 2 * sizeof(std::uint8_t);
  const double bytes = static_cast<double>(num_cells) * (of_points + of_slots + n * sizeof(Index));
  if (!fits(bytes))
    foresee_memory(
        bytes, "the geometry of " + std::to_string(num_cells) + " cells",
        what_would_fit(static_cast<double>(num_cells), bytes, "cells") + ": take fewer, or raise the limit");
}

}  // namespace

std::vector<double> ElementBlocks::local_values(const VectorX& world_values) const {
  std::vector<double> values(world_nodes.size() * stride());
  parallel_for(world_nodes.size(), nodes_per_chunk, [&](std::size_t begin, std::size_t end) {
    for (std::size_t node = begin; node < end; ++node) {
      const double* from = world_values.data() + Eigen::Index{dim} * world_nodes[node];
      for (int i = 0; i < dim; ++i) values[node * stride() + static_cast<std::size_t>(i)] = from[i];
    }
  });
  return values;
}

std::vector<double> ElementBlocks::local_displacements(const VectorX& x) const {
  std::vector<double> u(world_nodes.size() * stride());
  parallel_for(world_nodes.size(), nodes_per_chunk, [&](std::size_t begin, std::size_t end) {
    for (std::size_t node = begin; node < end; ++node) {
      const double* from = x.data() + Eigen::Index{dim} * world_nodes[node];
      for (int i = 0; i < dim; ++i) {
        const std::size_t at = node * stride() + static_cast<std::size_t>(i);
        u[at] = from[i] - rest_positions[at];
      }
    }
  });
  return u;
}

ElementBlocks make_element_blocks(const ElementInfo& element, const QuadratureRule& rule,
                                  std::span<const Index> cells, const VectorX& rest_positions) {
  ElementBlocks out;
  out.dim = element.dim;
  out.num_nodes = element.num_nodes;
  const auto n = static_cast<std::size_t>(element.num_nodes);
  out.num_cells = static_cast<Index>(cells.size() / n);
  out.num_blocks = (cells.size() / n + block_size - 1) / block_size;

  out.world_nodes = used_nodes(cells, static_cast<Index>(rest_positions.size() / element.dim));
  if (!are_in_order(cells, element, out.world_nodes.size()))
    sort_in_space(out.world_nodes, element.dim, rest_positions);
  out.rest_positions = out.local_values(rest_positions);
  const std::vector<Index> local = local_cells(cells, out.world_nodes);
  const std::vector<Index> order = sorted_cells(local, element.num_nodes);

  const std::size_t lanes = out.num_blocks * block_size;
  foresee_geometry(element, rule, lanes);
  out.cells = spread_over_blocks(order);
  assign_zeros(out.nodes, lanes * n);
  out.num_points = rule.points.size();
  assign_zeros(out.weights, lanes * out.num_points);
  if (!are_linear_simplices(element, out)) {
    assign_zeros(out.gradients, lanes * out.num_points * rows_of_point(element));
    out.reference_gradients = is_axisymmetric(element) ? reference_gradients_and_values(element, rule)
                                                       : reference_gradients(element, rule);
  }
  parallel_for(lanes, lanes_per_chunk, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) {
      const bool is_copy = out.cells[i] < 0;
      const auto cell = static_cast<std::size_t>(is_copy ? order.back() : out.cells[i]);
      fill_lane(element, rule, cells.subspan(cell * n, n), std::span(local).subspan(cell * n, n), is_copy,
                i / block_size, i % block_size, rest_positions, out);
    }
  });
  check_volumes(out);
  return out;
}

std::vector<OwnerPart> split_by_owner(const ElementBlocks& blocks, int count) {
  const auto num_nodes = static_cast<std::size_t>(blocks.num_local_nodes());
  const std::size_t lanes_per_block = static_cast<std::size_t>(blocks.num_nodes) * block_size;
  std::vector<std::size_t> touches(num_nodes, 0);
  for (const Index node : blocks.nodes) ++touches[static_cast<std::size_t>(node)];

  std::vector<OwnerPart> parts(static_cast<std::size_t>(count));
  std::vector<int> owner(num_nodes);
  std::size_t node = 0, touched = 0;
  for (std::size_t p = 0; p < parts.size(); ++p) {
    parts[p].owned.begin = static_cast<Index>(node);
    const std::size_t target = blocks.nodes.size() * (p + 1) / parts.size();
    while (node < num_nodes && (touched < target || p + 1 == parts.size())) {
      touched += touches[node];
      owner[node++] = static_cast<int>(p);
    }
    parts[p].owned.end = static_cast<Index>(node);
  }
  for (std::size_t block = 0; block < blocks.num_blocks; ++block)
    for (std::size_t i = 0; i < lanes_per_block; ++i) {
      auto& list = parts[static_cast<std::size_t>(
                             owner[static_cast<std::size_t>(blocks.nodes[block * lanes_per_block + i])])]
                       .blocks;
      if (list.empty() || list.back() != static_cast<Index>(block)) list.push_back(static_cast<Index>(block));
    }
  return parts;
}

}  // namespace resilin
