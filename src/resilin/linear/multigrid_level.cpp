#include "resilin/linear/multigrid_level.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>

#include "resilin/core/memory.hpp"
#include "resilin/core/parallel.hpp"
#include "resilin/linear/small_block.hpp"

namespace resilin {
namespace {

using detail::multigrid_kernels;

constexpr std::size_t numbers_per_task = 1 << 14;

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

void MultigridLevel::set_tentative(const std::vector<float>& modes) {
  constexpr std::size_t nodes_per_task = 4096;
  const auto numbers = static_cast<std::size_t>(block_size() * num_modes()),
             nodes = static_cast<std::size_t>(num_nodes());
  tentative.resize(modes.size() + static_cast<std::size_t>(lanes_of(num_modes())), nodes);
  const auto shorten = multigrid_kernels().shorten;
  parallel_for(nodes, nodes_per_task, [&](std::size_t first, std::size_t last) {
    for (std::size_t node = first; node < last; ++node)
      tentative.scales[node] =
          shorten(&modes[node * numbers], static_cast<Offset>(numbers), &tentative.numbers[node * numbers]);
  });
}

void MultigridLevel::allocate() {
  const auto n = static_cast<std::size_t>(num_nodes()),
             numbers = static_cast<std::size_t>(numbers_per_block());
  assign_zeros(blocks, (n + columns.size()) * numbers + static_cast<std::size_t>(lanes()));
  assign_zeros(inverse_diagonal, n * numbers + static_cast<std::size_t>(lanes()));
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
  struct Squares {
    double before = 0, after = 0;
    Squares& operator+=(const Squares& other) {
      before += other.before;
      after += other.after;
      return *this;
    }
  };
  parallel_for(x.size(), numbers_per_task, [&](std::size_t begin, std::size_t end) {
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
        parallel_sum<Squares>(x.size(), numbers_per_task, [&](std::size_t begin, std::size_t end) {
          Squares part;
          for (std::size_t k = begin; k < end; ++k) {
            if (static_cast<int>(k % lanes()) >= block_size()) continue;  // padding
            part.before += static_cast<double>(x[k]) * x[k];
            part.after += static_cast<double>(b[k]) * b[k];
          }
          return part;
        });
    estimate = static_cast<float>(std::sqrt(sum.after / sum.before));
    parallel_for(x.size(), numbers_per_task, [&](std::size_t begin, std::size_t end) {
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
  parallel_for(coarse.blocks.size(), numbers_per_task, [&](std::size_t begin, std::size_t end) {
    std::fill_n(coarse.blocks.begin() + static_cast<Offset>(begin), end - begin, 0.0F);
  });
  const detail::CoarseView to = coarse.writable();
  transfers.forward([&](const ColoredChunks::Rows& rows) {
    std::vector<float> work = row_work();
    std::vector<Index> place_of(static_cast<std::size_t>(coarse.num_nodes()), -1);
    project(view(), transfer(), {rows.first, rows.last}, work.data(), place_of.data(), to);
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
          .blocks = prolongation.view(),
          .tentative = tentative.view(),
          .lower_begin = lower.begin.data(),
          .lower_columns = lower.columns.data(),
          .lower_places = {narrow_places.lower.data(), wide_places.lower.data()},
          .smoothing_places = {narrow_places.smoothing.data(), wide_places.smoothing.data()},
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
