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
bool invert_block(const float* block, float* inverse) {
  constexpr double largest_shift = 1;
  const int lanes = MultigridLevel::lanes_of(size);
  double dense[size * size], result[size * size];
  for (int r = 0; r < size; ++r)
    for (int c = 0; c < size; ++c) dense[r * size + c] = static_cast<double>(block[r * lanes + c]);
  for (double shift = 1e-5; !invert_positive_definite<size>(dense, 1e-6, result); shift *= 4) {
    if (shift > largest_shift) return false;
    double largest = std::numeric_limits<float>::min();
    for (int d = 0; d < size; ++d) largest = std::max(largest, std::abs(dense[d * (size + 1)]));
    for (int d = 0; d < size; ++d) dense[d * (size + 1)] += shift * largest;
  }
  for (int r = 0; r < size; ++r)
    for (int c = 0; c < lanes; ++c)
      inverse[r * lanes + c] = c < size ? static_cast<float>(result[r * size + c]) : 0.0F;
  return true;
}

}  // namespace

void MultigridLevel::connect(const Aggregates& groups, MultigridLevel& coarse) {
  find_prolongation(groups);
  const ProductRows product = find_product_rows(groups.count);
  find_coarse_rows(groups.count, product, coarse);
  const auto block_numbers = static_cast<std::size_t>(block_size() * lanes_of(num_modes()));
  prolongation.resize(prolongation_columns.size() * block_numbers);
  const auto widest = std::max_element(product_width.begin(), product_width.end());
  row_work.resize((widest == product_width.end() ? 0U : *widest) * block_numbers);
}

/// A node reaches the groups of its neighbours, in the order in which they come.
void MultigridLevel::find_prolongation(const Aggregates& groups) {
  prolongation_begin.assign(1, 0);
  prolongation_columns.clear();
  smoothing_places.assign(full.columns.size(), -1);
  std::vector<Offset> entry_of(static_cast<std::size_t>(groups.count), -1);
  for (Index i = 0; i < num_nodes(); ++i) {
    const Offset begin = prolongation_begin.back();
    for (Offset e = full.begin[i]; e < full.begin[i + 1]; ++e) {
      const Index group = groups.of_node[full.columns[e]];
      if (group < 0 || groups.of_node[i] < 0) continue;
      if (entry_of[group] < begin) {
        entry_of[group] = static_cast<Offset>(prolongation_columns.size());
        prolongation_columns.push_back(group);
      }
      smoothing_places[e] = static_cast<std::int16_t>(entry_of[group] - begin);
    }
    prolongation_begin.push_back(static_cast<Offset>(prolongation_columns.size()));
  }
}

/// Rows of A P: the groups that the neighbours of a node reach.
MultigridLevel::ProductRows MultigridLevel::find_product_rows(Index num_groups) {
  ProductRows product;
  product.begin.assign(1, 0);
  product_width.clear();
  product_places.clear();
  std::vector<Offset> entry_of(static_cast<std::size_t>(num_groups), -1);
  for (Index i = 0; i < num_nodes(); ++i) {
    const Offset begin = product.begin.back();
    for (Offset e = full.begin[i]; e < full.begin[i + 1]; ++e) {
      const Index j = full.columns[e];
      for (Offset k = prolongation_begin[j]; k < prolongation_begin[j + 1]; ++k) {
        const Index group = prolongation_columns[k];
        if (entry_of[group] < begin) {
          entry_of[group] = static_cast<Offset>(product.columns.size());
          product.columns.push_back(group);
        }
        product_places.push_back(static_cast<std::uint16_t>(entry_of[group] - begin));
      }
    }
    product.begin.push_back(static_cast<Offset>(product.columns.size()));
    product_width.push_back(static_cast<std::uint16_t>(product.begin.back() - begin));
  }
  return product;
}

/// Upper rows of P^T A P, each from the fine nodes that reach its group, and where every product is added.
void MultigridLevel::find_coarse_rows(Index num_groups, const ProductRows& product, MultigridLevel& coarse) {
  struct Reach {
    Index fine_node;
    Offset first_target;  // of the node's products with this group, in coarse_blocks
  };
  std::vector<Offset> reach_begin(static_cast<std::size_t>(num_groups) + 1, 0);
  for (const Index group : prolongation_columns) ++reach_begin[group + 1];
  for (Index group = 0; group < num_groups; ++group) reach_begin[group + 1] += reach_begin[group];
  std::vector<Reach> reach(prolongation_columns.size());
  std::vector<Offset> next(reach_begin.begin(), reach_begin.end() - 1);
  Offset num_targets = 0;
  for (Index i = 0; i < num_nodes(); ++i)
    for (Offset k = prolongation_begin[i]; k < prolongation_begin[i + 1]; ++k) {
      reach[next[prolongation_columns[k]]++] = {i, num_targets};
      num_targets += product_width[i];
    }

  coarse.row_begin.assign(1, 0);
  coarse.columns.clear();
  coarse_blocks.assign(static_cast<std::size_t>(num_targets), -1);
  std::vector<Index> seen_in_row(static_cast<std::size_t>(num_groups), -1), block_of(seen_in_row);
  for (Index group = 0; group < num_groups; ++group) {
    const Offset begin = coarse.row_begin.back();
    const auto for_products = [&](const auto& visit) {
      for (Offset t = reach_begin[group]; t < reach_begin[group + 1]; ++t) {
        const Offset first = product.begin[reach[t].fine_node], last = product.begin[reach[t].fine_node + 1];
        for (Offset c = first; c < last; ++c) visit(product.columns[c], reach[t].first_target + c - first);
      }
    };
    for_products([&](Index column, Offset) {
      if (column <= group || seen_in_row[column] == group) return;
      seen_in_row[column] = group;
      coarse.columns.push_back(column);
    });
    std::sort(coarse.columns.begin() + begin, coarse.columns.end());
    coarse.row_begin.push_back(static_cast<Offset>(coarse.columns.size()));
    block_of[group] = group;
    for (Offset k = begin; k < coarse.row_begin.back(); ++k)
      block_of[coarse.columns[k]] = num_groups + static_cast<Index>(k);
    for_products([&](Index column, Offset target) {
      if (column >= group) coarse_blocks[target] = block_of[column];
    });
  }
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

bool MultigridLevel::invert_diagonal() {
  const int size = block_size(), numbers = numbers_per_block();
  for (std::size_t unknown = 0; unknown < is_absent.size(); ++unknown) {
    const std::size_t node = unknown / size, d = unknown % size;
    if (is_absent[unknown] != 0) blocks[node * numbers + d * (lanes() + 1)] = 1;
  }
  const auto invert = size == 2 ? invert_block<2> : size == 3 ? invert_block<3> : invert_block<6>;
  for (Index i = 0; i < num_nodes(); ++i) {
    const std::size_t first = static_cast<std::size_t>(i) * numbers;
    if (!invert(&blocks[first], &inverse_diagonal[first])) return false;
  }
  return true;
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
