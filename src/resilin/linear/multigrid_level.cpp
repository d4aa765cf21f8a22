#include "resilin/linear/multigrid_level.hpp"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cassert>
#include <cmath>
#include <limits>
#include <numeric>
#include <span>

#include "resilin/core/parallel.hpp"
#include "resilin/linear/ordering.hpp"
#include "resilin/linear/small_block.hpp"

namespace resilin {
namespace {

using detail::multigrid_kernels;

/// Inverts one block; its diagonal is raised until it is definite.
template <int size>
bool invert_block(const float* block, float* inverse) {
  constexpr double largest_shift = 1;
  double dense[size * size], result[size * size];
  for (int k = 0; k < size * size; ++k) dense[k] = static_cast<double>(block[k]);
  for (double shift = 1e-5; !invert_positive_definite<size>(dense, 1e-6, result); shift *= 4) {
    if (shift > largest_shift) return false;
    double largest = std::numeric_limits<float>::min();
    for (int d = 0; d < size; ++d) largest = std::max(largest, std::abs(dense[d * (size + 1)]));
    for (int d = 0; d < size; ++d) dense[d * (size + 1)] += shift * largest;
  }
  for (int k = 0; k < size * size; ++k) inverse[k] = static_cast<float>(result[k]);
  return true;
}

/// In [-1, 1), without any order (a mixing of the bits of k).
double noise(std::size_t k) {
  auto bits = static_cast<std::uint32_t>(k);
  for (int round = 0; round < 2; ++round) bits = (bits ^ bits >> 16U) * 0x45d9f3bU + 1;
  return static_cast<double>(bits >> 8U) / 8388608.0 - 1.0;
}

}  // namespace

bool MultigridLevel::connect(Aggregates& groups, MultigridLevel& coarse) {
  if (!find_prolongation(groups)) return false;
  const ProductRows product = find_product_rows(groups.count);
  if (widest_product_ > std::numeric_limits<std::uint16_t>::max()) return false;
  const NodeGraph graph = couple_groups(product);
  SweepOrder order = two_color_order(graph, coarse.least_couplings());
  if (!find_coarse_rows(product, graph, order, coarse)) return false;
  coarse.sweeps = std::move(order.chunks);
  coarse.along_layers = std::move(order.along_layers);
  const std::vector<Index> number = inverse_of(order.node_at);
  for (Index& group : groups.of_node)
    if (group >= 0) group = number[group];
  for (Index& group : prolongation_columns) group = number[group];
  color_transfers(groups.count);
  narrow_the_places();
  prolongation.resize(prolongation_columns.size() * static_cast<std::size_t>(block_size() * num_modes()) +
                      static_cast<std::size_t>(lanes_of(num_modes())));
  return true;
}

/// A node reaches the groups of its neighbours, in the order in which they come.
bool MultigridLevel::find_prolongation(const Aggregates& groups) {
  prolongation_begin.assign(1, 0);
  prolongation_columns.clear();
  const FullPattern pattern = full();
  constexpr auto none = std::numeric_limits<std::uint16_t>::max();
  std::vector<std::uint16_t>& places = wide_places.smoothing;
  places.reserve(pattern.num_entries());
  std::vector<Offset> entry_of(static_cast<std::size_t>(groups.count), -1);
  for (Index i = 0; i < num_nodes(); ++i) {
    const Offset begin = prolongation_begin.back();
    pattern.for_row(i, [&](Index j) {
      const Index group = groups.of_node[j];
      places.push_back(none);
      if (group < 0 || groups.of_node[i] < 0) return;
      if (entry_of[group] < begin) {
        entry_of[group] = static_cast<Offset>(prolongation_columns.size());
        prolongation_columns.push_back(group);
      }
      places.back() = static_cast<std::uint16_t>(entry_of[group] - begin);
    });
    prolongation_begin.push_back(static_cast<Offset>(prolongation_columns.size()));
    if (prolongation_begin.back() - begin > none) return false;
  }
  prolongation_columns.shrink_to_fit();
  return true;
}

/// Rows of A P: the groups that the neighbours of a node reach.
MultigridLevel::ProductRows MultigridLevel::find_product_rows(Index num_groups) {
  ProductRows product;
  product.begin.assign(1, 0);
  product_width.clear();
  const FullPattern pattern = full();
  std::vector<std::uint16_t>& places = wide_places.product;
  product_begin.assign(1, 0);
  target_begin.assign(1, 0);
  widest_product_ = 0;
  std::vector<Offset> entry_of(static_cast<std::size_t>(num_groups), -1);
  for (Index i = 0; i < num_nodes(); ++i) {
    const Offset begin = product.begin.back();
    pattern.for_row(i, [&](Index j) {
      for (Offset k = prolongation_begin[j]; k < prolongation_begin[j + 1]; ++k) {
        const Index group = prolongation_columns[k];
        if (entry_of[group] < begin) {
          entry_of[group] = static_cast<Offset>(product.columns.size());
          product.columns.push_back(group);
        }
        places.push_back(static_cast<std::uint16_t>(entry_of[group] - begin));
      }
    });
    const Offset width = static_cast<Offset>(product.columns.size()) - begin;
    product.begin.push_back(begin + width);
    widest_product_ = std::max(widest_product_, static_cast<std::size_t>(width));
    product_width.push_back(static_cast<std::uint16_t>(width));
    product_begin.push_back(static_cast<Offset>(places.size()));
    target_begin.push_back(target_begin.back() + width * (prolongation_begin[i + 1] - prolongation_begin[i]));
  }

  product.reach_begin.assign(static_cast<std::size_t>(num_groups) + 1, 0);
  for (const Index group : prolongation_columns) ++product.reach_begin[group + 1];
  std::partial_sum(product.reach_begin.begin(), product.reach_begin.end(), product.reach_begin.begin());
  product.reach_nodes.resize(prolongation_columns.size());
  product.reach_targets.resize(prolongation_columns.size());
  std::vector<Offset> next(product.reach_begin.begin(), product.reach_begin.end() - 1);
  for (Index i = 0; i < num_nodes(); ++i)
    for (Offset k = prolongation_begin[i]; k < prolongation_begin[i + 1]; ++k) {
      const Offset at = next[prolongation_columns[k]]++;
      product.reach_nodes[at] = i;
      product.reach_targets[at] = target_begin[i] + product_width[i] * (k - prolongation_begin[i]);
    }
  return product;
}

/// Which groups meet in P^T A P.
NodeGraph MultigridLevel::couple_groups(const ProductRows& product) {
  const auto num_groups = static_cast<Index>(product.reach_begin.size()) - 1;
  NodeGraph graph;
  graph.begin.assign(1, 0);
  std::vector<Index> seen_in_row(static_cast<std::size_t>(num_groups), -1);
  for (Index group = 0; group < num_groups; ++group) {
    product.for_each(group, [&](Index column, Offset) {
      if (column == group || seen_in_row[column] == group) return;
      seen_in_row[column] = group;
      graph.neighbours.push_back(column);
    });
    std::sort(graph.neighbours.begin() + graph.begin.back(), graph.neighbours.end());
    graph.begin.push_back(static_cast<Index>(graph.neighbours.size()));
  }
  return graph;
}

/// Upper rows of P^T A P in the order given, and to which of their blocks every product of a fine node is
/// added.
bool MultigridLevel::find_coarse_rows(const ProductRows& product, const NodeGraph& graph,
                                      const SweepOrder& order, MultigridLevel& coarse) {
  const Index num_groups = graph.num_nodes();
  const std::vector<Index> number = inverse_of(order.node_at);
  coarse.row_begin.assign(1, 0);
  coarse.columns.clear();
  wide_places.coarse.assign(static_cast<std::size_t>(target_begin.back()), 0);
  std::vector<std::uint16_t> place_of(static_cast<std::size_t>(num_groups), 0);
  for (Index row = 0; row < num_groups; ++row) {
    const Index group = order.node_at[row];
    const Offset begin = coarse.row_begin.back();
    for (Index k = graph.begin[group]; k < graph.begin[group + 1]; ++k)
      if (number[graph.neighbours[k]] > row) coarse.columns.push_back(number[graph.neighbours[k]]);
    std::sort(coarse.columns.begin() + begin, coarse.columns.end());
    coarse.row_begin.push_back(static_cast<Offset>(coarse.columns.size()));
    if (coarse.row_begin.back() - begin > std::numeric_limits<std::uint16_t>::max() - 2) return false;
    place_of[row] = 1;
    for (Offset k = begin; k < coarse.row_begin.back(); ++k)
      place_of[coarse.columns[k]] = static_cast<std::uint16_t>(2 + k - begin);
    product.for_each(group, [&](Index column, Offset target) {
      if (number[column] >= row) wide_places.coarse[target] = place_of[number[column]];
    });
  }
  coarse.columns.shrink_to_fit();
  return true;
}

/// In most levels one byte is enough for the maps: rows of the prolongation and of both products are short.
void MultigridLevel::narrow_the_places() {
  constexpr std::uint16_t none = 0xffff, most = 0xff;
  Places<std::uint8_t> narrow;
  const auto take = [&](const auto& wide, auto& into) {
    into.reserve(wide.size());
    for (const std::uint16_t place : wide) {
      if (place >= most && place != none) return false;
      into.push_back(static_cast<std::uint8_t>(std::min(place, most)));
    }
    return true;
  };
  if (!take(wide_places.smoothing, narrow.smoothing) || !take(wide_places.product, narrow.product) ||
      !take(wide_places.coarse, narrow.coarse))
    return;
  narrow_places = std::move(narrow);
  wide_places = {};
}

/// Each chunk of the sweeps takes the first colour that no chunk has with which it shares a group.
void MultigridLevel::color_transfers(Index num_groups) {
  std::vector<std::uint64_t> colors_at(static_cast<std::size_t>(num_groups), 0);
  std::vector<std::vector<ColoredChunks::Rows>> by_color;
  for (const ColoredChunks::Rows& rows : sweeps.chunks) {
    const auto groups = std::span(prolongation_columns)
                            .subspan(static_cast<std::size_t>(prolongation_begin[rows.first]),
                                     static_cast<std::size_t>(prolongation_begin[rows.last] -
                                                              prolongation_begin[rows.first]));
    std::uint64_t taken = 0;
    for (const Index group : groups) taken |= colors_at[group];
    const auto color = static_cast<std::size_t>(std::countr_one(taken));
    assert(color < 64 && "there are no more chunks than that");
    for (const Index group : groups) colors_at[group] |= std::uint64_t{1} << color;
    by_color.resize(std::max(by_color.size(), color + 1));
    by_color[color].push_back(rows);
  }
  transfers = {};
  for (const auto& chunks : by_color) {
    transfers.color_begin.push_back(transfers.chunks.size());
    transfers.chunks.insert(transfers.chunks.end(), chunks.begin(), chunks.end());
  }
  transfers.color_begin.push_back(transfers.chunks.size());
}

void MultigridLevel::set_tentative(const std::vector<float>& modes) {
  tentative.resize(modes.size() + static_cast<std::size_t>(lanes_of(num_modes())));
  std::ranges::copy(modes, tentative.begin());
}

void MultigridLevel::allocate() {
  const auto n = static_cast<std::size_t>(num_nodes()),
             numbers = static_cast<std::size_t>(numbers_per_block());
  blocks.assign((n + columns.size()) * numbers + static_cast<std::size_t>(lanes()), 0.0F);
  inverse_diagonal.assign(n * numbers + static_cast<std::size_t>(lanes()), 0.0F);
  for (std::vector<float>* vector : {&x, &r, &b}) vector->assign(n * lanes(), 0.0F);
}

bool MultigridLevel::invert_diagonal() {
  const int size = block_size(), numbers = numbers_per_block();
  for (std::size_t unknown = 0; unknown < is_absent.size(); ++unknown) {
    const std::size_t node = unknown / size, d = unknown % size;
    if (is_absent[unknown] != 0) blocks[node * numbers + d * (static_cast<std::size_t>(size) + 1)] = 1;
  }
  const auto invert = size == 2 ? invert_block<2> : size == 3 ? invert_block<3> : invert_block<6>;
  std::atomic<bool> is_definite = true;
  sweeps.at_once([&](const ColoredChunks::Rows& rows) {
    for (Index i = rows.first; i < rows.last; ++i) {
      const std::size_t first = static_cast<std::size_t>(i) * numbers;
      if (!invert(&blocks[first], &inverse_diagonal[first])) is_definite = false;
    }
  });
  return is_definite;
}

float MultigridLevel::largest_eigenvalue() {
  constexpr int iterations = 8;
  constexpr std::size_t numbers_per_chunk = 1 << 15;
  struct Squares {
    double before = 0, after = 0;
    Squares& operator+=(const Squares& other) {
      before += other.before;
      after += other.after;
      return *this;
    }
  };
  parallel_for(x.size(), numbers_per_chunk, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) x[k] = static_cast<float>(noise(k));
  });
  const auto apply_inverse = of_kind(multigrid_kernels().apply_inverse_diagonal);
  float estimate = 1;
  for (int iteration = 0; iteration < iterations; ++iteration) {
    multiply(x, r);
    sweeps.at_once([&](const ColoredChunks::Rows& rows) {
      apply_inverse(view(), {rows.first, rows.last}, r.data(), b.data());
    });
    const auto sum =
        parallel_sum<Squares>(x.size(), numbers_per_chunk, [&](std::size_t begin, std::size_t end) {
          Squares part;
          for (std::size_t k = begin; k < end; ++k) {
            if (static_cast<int>(k % lanes()) >= block_size()) continue;  // padding
            part.before += static_cast<double>(x[k]) * x[k];
            part.after += static_cast<double>(b[k]) * b[k];
          }
          return part;
        });
    estimate = static_cast<float>(std::sqrt(sum.after / sum.before));
    parallel_for(x.size(), numbers_per_chunk, [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k < end; ++k) x[k] = b[k] / estimate;
    });
  }
  return estimate;
}

void MultigridLevel::project_to(MultigridLevel& coarse) {
  const float damping = 4.0F / 3.0F / largest_eigenvalue();
  const auto smooth = of_places(multigrid_kernels().smooth_prolongation);
  const auto project = of_places(multigrid_kernels().galerkin_product);
  sweeps.at_once([&](const ColoredChunks::Rows& rows) {
    std::vector<float> work = row_work();
    smooth(view(), transfer(), {rows.first, rows.last}, damping, work.data());
  });
  std::fill(coarse.blocks.begin(), coarse.blocks.end(), 0.0F);
  const detail::CoarseView to = coarse.writable();
  transfers.forward([&](const ColoredChunks::Rows& rows) {
    std::vector<float> work = row_work();
    project(view(), transfer(), {rows.first, rows.last}, work.data(), to);
  });
}

void MultigridLevel::multiply(const std::vector<float>& from, std::vector<float>& to) const {
  const auto multiply_add = of_kind(multigrid_kernels().multiply_add);
  sweeps.at_once([&](const ColoredChunks::Rows& rows) {
    std::fill(to.begin() + rows.first * lanes(), to.begin() + rows.last * lanes(), 0.0F);
  });
  sweeps.forward([&](const ColoredChunks::Rows& rows) {
    multiply_add(view(), {rows.first, rows.last}, from.data(), to.data());
  });
}

void MultigridLevel::pre_smooth() {
  const auto sweep = of_kind(multigrid_kernels().sweep_forward);
  const auto negate_upper = of_kind(multigrid_kernels().negate_upper);
  sweeps.at_once([&](const ColoredChunks::Rows& rows) {
    std::copy(r.begin() + rows.first * lanes(), r.begin() + rows.last * lanes(),
              b.begin() + rows.first * lanes());
  });
  sweeps.forward(
      [&](const ColoredChunks::Rows& rows) { sweep(view(), {rows.first, rows.last}, r.data(), x.data()); });
  // b - (D + L) x = 0: what is left is -U x.
  sweeps.at_once([&](const ColoredChunks::Rows& rows) {
    negate_upper(view(), {rows.first, rows.last}, x.data(), r.data());
  });
}

void MultigridLevel::post_smooth() {
  const auto subtract_lower = of_kind(multigrid_kernels().subtract_lower);
  const auto sweep = of_kind(multigrid_kernels().sweep_backward);
  sweeps.forward([&](const ColoredChunks::Rows& rows) {
    subtract_lower(view(), {rows.first, rows.last}, x.data(), b.data());
  });
  sweeps.backward(
      [&](const ColoredChunks::Rows& rows) { sweep(view(), {rows.first, rows.last}, b.data(), x.data()); });
}

void MultigridLevel::restrict_to(MultigridLevel& coarse) {
  const auto restrict_add = of_kind(multigrid_kernels().restrict_add);
  std::fill(coarse.r.begin(), coarse.r.end(), 0.0F);
  transfers.forward([&](const ColoredChunks::Rows& rows) {
    restrict_add(transfer(), {rows.first, rows.last}, r.data(), coarse.r.data());
  });
}

void MultigridLevel::prolong_from(const MultigridLevel& coarse) {
  const auto prolong_add = of_kind(multigrid_kernels().prolong_add);
  sweeps.at_once([&](const ColoredChunks::Rows& rows) {
    prolong_add(transfer(), {rows.first, rows.last}, coarse.x.data(), x.data());
  });
}

detail::LevelView MultigridLevel::view() const {
  return {.row_begin = row_begin.data(),
          .columns = columns.data(),
          .upper = blocks.data() + static_cast<Offset>(num_nodes()) * numbers_per_block(),
          .diagonal = blocks.data(),
          .inverse_diagonal = inverse_diagonal.data()};
}

detail::TransferView MultigridLevel::transfer() {
  return {.row_begin = prolongation_begin.data(),
          .columns = prolongation_columns.data(),
          .blocks = prolongation.data(),
          .tentative = tentative.data(),
          .lower_begin = lower.begin.data(),
          .lower_columns = lower.columns.data(),
          .lower_entries = lower.entries.data(),
          .smoothing_places = {narrow_places.smoothing.data(), wide_places.smoothing.data()},
          .product_width = product_width.data(),
          .product_begin = product_begin.data(),
          .product_places = {narrow_places.product.data(), wide_places.product.data()},
          .target_begin = target_begin.data(),
          .coarse_places = {narrow_places.coarse.data(), wide_places.coarse.data()}};
}

detail::CoarseView MultigridLevel::writable() {
  return {.row_begin = row_begin.data(),
          .diagonal = blocks.data(),
          .upper = blocks.data() + static_cast<Offset>(num_nodes()) * numbers_per_block()};
}

std::vector<float> MultigridLevel::row_work() const {
  return std::vector<float>(widest_product_ * static_cast<std::size_t>(block_size() * lanes_of(num_modes())));
}

}  // namespace resilin
