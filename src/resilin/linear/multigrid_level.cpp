#include "resilin/linear/multigrid_level.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "resilin/linear/small_block.hpp"

namespace resilin {
namespace {

using detail::multigrid_kernels;

/// Inverts one padded block; its diagonal is raised until it is definite.
template <int size>
void invert_block(const float* block, float* inverse) {
  const int lanes = MultigridLevel::lanes_of(size);
  double dense[size * size], result[size * size];
  for (int r = 0; r < size; ++r)
    for (int c = 0; c < size; ++c) dense[r * size + c] = static_cast<double>(block[r * lanes + c]);
  for (double shift = 1e-5; !invert_positive_definite<size>(dense, 1e-6, result); shift *= 4) {
    double largest = std::numeric_limits<float>::min();
    for (int d = 0; d < size; ++d) largest = std::max(largest, std::abs(dense[d * (size + 1)]));
    for (int d = 0; d < size; ++d) dense[d * (size + 1)] += shift * largest;
  }
  for (int r = 0; r < size; ++r)
    for (int c = 0; c < lanes; ++c)
      inverse[r * lanes + c] = c < size ? static_cast<float>(result[r * size + c]) : 0.0F;
}

}  // namespace

void MultigridLevel::connect(const Aggregates& groups, MultigridLevel& coarse) {
  const Index n = num_nodes();
  // Prolongation: a node reaches the groups of its neighbours.
  prolongation_begin.assign(1, 0);
  prolongation_columns.clear();
  smoothing_places.assign(full.columns.size(), -1);
  std::vector<Index> place(static_cast<std::size_t>(groups.count), -1);
  for (Index i = 0; i < n; ++i) {
    const Offset begin = prolongation_begin.back();
    if (groups.of_node[i] >= 0) {
      for (Offset e = full.begin[i]; e < full.begin[i + 1]; ++e) {
        const Index group = groups.of_node[full.columns[e]];
        if (group < 0) continue;
        const bool is_new = place[group] < begin ||
                            place[group] >= static_cast<Index>(prolongation_columns.size()) ||
                            prolongation_columns[place[group]] != group;
        if (is_new) {
          place[group] = static_cast<Index>(prolongation_columns.size());
          prolongation_columns.push_back(group);
        }
        smoothing_places[e] = static_cast<std::int16_t>(place[group] - begin);
      }
    }
    prolongation_begin.push_back(static_cast<Offset>(prolongation_columns.size()));
  }
  // Rows of A P.
  product_width.clear();
  product_places.clear();
  std::vector<Offset> product_begin(1, 0);
  std::vector<Index> product_columns;
  std::vector<Offset> product_place(static_cast<std::size_t>(groups.count), -1);
  for (Index i = 0; i < n; ++i) {
    const Offset begin = product_begin.back();
    for (Offset e = full.begin[i]; e < full.begin[i + 1]; ++e) {
      const Index j = full.columns[e];
      for (Offset k = prolongation_begin[j]; k < prolongation_begin[j + 1]; ++k) {
        const Index group = prolongation_columns[k];
        if (product_place[group] < begin) {
          product_place[group] = static_cast<Offset>(product_columns.size());
          product_columns.push_back(group);
        }
        product_places.push_back(static_cast<std::uint16_t>(product_place[group] - begin));
      }
    }
    product_begin.push_back(static_cast<Offset>(product_columns.size()));
    product_width.push_back(static_cast<std::uint16_t>(product_begin.back() - begin));
  }
  // Coarse rows, each from the fine nodes that it reaches.
  std::vector<Offset> target_begin(prolongation_columns.size());
  std::vector<Offset> reach_begin(static_cast<std::size_t>(groups.count) + 1, 0);
  Offset num_targets = 0;
  for (Index i = 0; i < n; ++i)
    for (Offset k = prolongation_begin[i]; k < prolongation_begin[i + 1]; ++k) {
      target_begin[k] = num_targets;
      num_targets += product_width[i];
      ++reach_begin[prolongation_columns[k] + 1];
    }
  for (Index group = 0; group < groups.count; ++group) reach_begin[group + 1] += reach_begin[group];
  std::vector<std::pair<Index, Offset>> reach(prolongation_columns.size());  // fine node, prolongation entry
  std::vector<Offset> next(reach_begin.begin(), reach_begin.end() - 1);
  for (Index i = 0; i < n; ++i)
    for (Offset k = prolongation_begin[i]; k < prolongation_begin[i + 1]; ++k)
      reach[next[prolongation_columns[k]]++] = {i, k};
  coarse.row_begin.assign(1, 0);
  coarse.columns.clear();
  coarse_blocks.assign(static_cast<std::size_t>(num_targets), -1);
  std::vector<Index> block_of(static_cast<std::size_t>(groups.count), -1);
  std::vector<Index> seen_in_row(static_cast<std::size_t>(groups.count), -1);
  for (Index group = 0; group < groups.count; ++group) {
    const Offset begin = coarse.row_begin.back();
    for (Offset t = reach_begin[group]; t < reach_begin[group + 1]; ++t)
      for (Offset c = product_begin[reach[t].first]; c < product_begin[reach[t].first + 1]; ++c) {
        const Index column = product_columns[c];
        if (column <= group || seen_in_row[column] == group) continue;
        seen_in_row[column] = group;
        coarse.columns.push_back(column);
      }
    std::sort(coarse.columns.begin() + begin, coarse.columns.end());
    coarse.row_begin.push_back(static_cast<Offset>(coarse.columns.size()));
    for (Offset k = begin; k < coarse.row_begin.back(); ++k)
      block_of[coarse.columns[k]] = groups.count + static_cast<Index>(k);
    block_of[group] = group;
    for (Offset t = reach_begin[group]; t < reach_begin[group + 1]; ++t) {
      const auto [i, k] = reach[t];
      for (Offset c = product_begin[i]; c < product_begin[i + 1]; ++c)
        if (product_columns[c] >= group)
          coarse_blocks[target_begin[k] + c - product_begin[i]] = block_of[product_columns[c]];
    }
  }
  const int mode_lanes = lanes_of(num_modes());
  const auto block_numbers = static_cast<std::size_t>(block_size() * mode_lanes);
  prolongation.resize(prolongation_columns.size() * block_numbers);
  const std::uint16_t widest =
      product_width.empty() ? 0 : *std::max_element(product_width.begin(), product_width.end());
  row_work.resize(widest * block_numbers);
}

void MultigridLevel::set_tentative(const Modes& modes) {
  const int mode_lanes = lanes_of(modes.count);
  tentative.assign(static_cast<std::size_t>(num_nodes()) * modes.size * mode_lanes, 0.0F);
  for (std::size_t row = 0; row < static_cast<std::size_t>(num_nodes()) * modes.size; ++row)
    for (int c = 0; c < modes.count; ++c)
      tentative[row * mode_lanes + c] = static_cast<float>(modes.values[row * modes.count + c]);
}

void MultigridLevel::allocate() {
  const auto n = static_cast<std::size_t>(num_nodes()),
             numbers = static_cast<std::size_t>(numbers_per_block());
  blocks.assign((n + columns.size()) * numbers, 0.0F);
  inverse_diagonal.assign(n * numbers, 0.0F);
  for (std::vector<float>* vector : {&x, &r, &b}) vector->assign(n * lanes(), 0.0F);
}

void MultigridLevel::invert_diagonal() {
  const int size = block_size(), numbers = numbers_per_block();
  for (std::size_t unknown = 0; unknown < is_absent.size(); ++unknown) {
    const std::size_t node = unknown / size, d = unknown % size;
    if (is_absent[unknown] != 0) blocks[node * numbers + d * (lanes() + 1)] = 1;
  }
  const auto invert = size == 2 ? invert_block<2> : size == 3 ? invert_block<3> : invert_block<6>;
  for (Index i = 0; i < num_nodes(); ++i)
    invert(&blocks[static_cast<std::size_t>(i) * numbers],
           &inverse_diagonal[static_cast<std::size_t>(i) * numbers]);
}

float MultigridLevel::largest_eigenvalue() {
  constexpr int iterations = 8;
  std::uint32_t state = 12345;
  for (float& value : x) {
    state = 1664525U * state + 1013904223U;  // any vector that is not smooth
    value = static_cast<float>(state >> 8U) / 8388608.0F - 1.0F;
  }
  const auto multiply = multigrid_kernels().multiply[dim - 2][is_given ? 0 : 1];
  const auto apply_inverse = multigrid_kernels().apply_inverse_diagonal[dim - 2][is_given ? 0 : 1];
  float estimate = 1;
  for (int iteration = 0; iteration < iterations; ++iteration) {
    multiply(view(), x.data(), r.data());
    apply_inverse(view(), r.data(), b.data());
    double before = 0, after = 0;
    for (std::size_t k = 0; k < x.size(); ++k) {
      const auto is_padding = static_cast<int>(k % lanes()) >= block_size();
      if (is_padding) continue;
      before += static_cast<double>(x[k]) * x[k];
      after += static_cast<double>(b[k]) * b[k];
    }
    estimate = static_cast<float>(std::sqrt(after / before));
    for (std::size_t k = 0; k < x.size(); ++k) x[k] = b[k] / estimate;
  }
  return estimate;
}

void MultigridLevel::project_to(MultigridLevel& coarse) {
  const int kind = is_given ? 0 : 1;
  multigrid_kernels().smooth_prolongation[dim - 2][kind](view(), transfer(),
                                                         4.0F / 3.0F / largest_eigenvalue());
  std::fill(coarse.blocks.begin(), coarse.blocks.end(), 0.0F);
  multigrid_kernels().galerkin_product[dim - 2][kind](view(), transfer(), row_work.data(),
                                                      coarse.blocks.data());
}

detail::LevelView MultigridLevel::view() const {
  return {.num_nodes = num_nodes(),
          .row_begin = row_begin.data(),
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
          .full_begin = full.begin.data(),
          .full_blocks = full.blocks.data(),
          .full_columns = full.columns.data(),
          .smoothing_places = smoothing_places.data(),
          .product_width = product_width.data(),
          .product_places = product_places.data(),
          .coarse_blocks = coarse_blocks.data()};
}

}  // namespace resilin
