#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "resilin/core/cpu.hpp"
#include "resilin/linear/kernels/block_kernels.hpp"
#include "resilin/linear/kernels/multigrid_kernels.hpp"
#include "sample_matrix.hpp"

namespace resilin::detail {
namespace {

/// Sets that this machine does not run cannot be tested on it. Every set must agree with the plainest to
/// round-off.
struct EveryInstructionSet : ::testing::TestWithParam<InstructionSet> {
  const BlockKernels& kernels = block_kernels(GetParam());
  const BlockKernels& plain = block_kernels(available_instruction_sets().front());
  const MultigridKernels& multigrid = multigrid_kernels(GetParam());
  const MultigridKernels& plain_multigrid = multigrid_kernels(available_instruction_sets().front());
};
INSTANTIATE_TEST_SUITE_P(Kernels, EveryInstructionSet, ::testing::ValuesIn(available_instruction_sets()),
                         [](const auto& set) { return std::string(name(set.param)); });

TEST(LinearKernels, AreThoseOfThePreferredInstructionSet) {
  EXPECT_EQ(&block_kernels(), &block_kernels(preferred_instruction_set()));
  EXPECT_EQ(&multigrid_kernels(), &multigrid_kernels(preferred_instruction_set()));
}

std::vector<double> random_numbers(std::size_t count) {
  const VectorX numbers = VectorX::Random(static_cast<Eigen::Index>(count));
  return {numbers.begin(), numbers.end()};
}

template <class Number>
double relative_difference(const std::vector<Number>& a, const std::vector<Number>& b) {
  double difference = 0, size = 0;
  for (std::size_t k = 0; k < a.size(); ++k) {
    difference += std::pow(static_cast<double>(a[k] - b[k]), 2);
    size += std::pow(static_cast<double>(a[k]), 2);
  }
  return std::sqrt(difference / size);
}

TEST_P(EveryInstructionSet, MultipliesAlike) {
  for (const int dim : {2, 3}) {
    const BlockMatrix A = testing::sample_matrix(dim, 100, 1, 0);
    const BlockPattern& pattern = *A.pattern;
    const std::vector<double> x = random_numbers(static_cast<std::size_t>(A.num_unknowns()));
    std::vector<double> y[2];
    for (const bool is_plain : {true, false}) {
      std::vector<double>& result = y[is_plain ? 0 : 1];
      result.assign(x.size(), 0.0);
      (is_plain ? plain : kernels)
          .multiply_rows[dim - 2](pattern.row_begin.data(), pattern.columns.data(), pattern.columns.data(),
                                  A.values.data(), x.data(), result.data(), 0, A.num_nodes());
    }
    EXPECT_LT(relative_difference(y[0], y[1]), 1e-15);
  }
}

TEST_P(EveryInstructionSet, EliminatesAndSolvesAlike) {
  // Three nodes, all coupled: slots 0-2 are diagonal, 3 = (0, 1), 4 = (0, 2), 5 = (1, 2).
  const std::vector<KernelIndex> pairs = {1, 5, 2, 2};
  const std::vector<KernelOffset> row_begin = {0, 2, 3, 3};
  const std::vector<KernelIndex> columns = {1, 2, 2};
  for (const int dim : {2, 3}) {
    const std::size_t block = dim == 3 ? 12 : 4;
    const std::vector<double> start = random_numbers(6 * block), inverse = random_numbers(9);
    const std::vector<double> numbers = random_numbers(100), r = random_numbers(9);
    const std::vector<float> upper(numbers.begin(), numbers.begin() + 50),
        diagonal(numbers.begin() + 50, numbers.end());
    std::vector<double> work[2];
    std::vector<float> z[2];
    for (const bool is_plain : {true, false}) {
      const BlockKernels& set = is_plain ? plain : kernels;
      work[is_plain ? 0 : 1] = start;
      set.eliminate_row[dim - 2](work[is_plain ? 0 : 1].data(), 3, 5, pairs.data(), inverse.data());
      z[is_plain ? 0 : 1].assign(r.begin(), r.begin() + 3 * dim);
      set.solve_lower[dim - 2](row_begin.data(), columns.data(), upper.data(), z[is_plain ? 0 : 1].data(), 0,
                               3);
      set.solve_upper[dim - 2](row_begin.data(), columns.data(), upper.data(), diagonal.data(),
                               z[is_plain ? 0 : 1].data(), 0, 3);
    }
    EXPECT_LT(relative_difference(work[0], work[1]), 1e-14);
    EXPECT_LT(relative_difference(z[0], z[1]), 1e-5F);
    EXPECT_GT(relative_difference(work[0], start), 0.01) << "nothing was done";
  }
}

TEST_P(EveryInstructionSet, SumsAlike) {
  for (const std::size_t size : {3U, 16U, 1001U}) {
    const std::vector<double> a = random_numbers(size), b = random_numbers(size);
    const auto n = static_cast<KernelOffset>(size);
    EXPECT_NEAR(kernels.dot(a.data(), b.data(), n), plain.dot(a.data(), b.data(), n),
                1e-13 * std::sqrt(double(n)));
    std::vector<double> y = b, plain_y = b;
    kernels.axpy(0.7, a.data(), y.data(), n);
    kernels.xpby(a.data(), -0.3, y.data(), n);
    plain.axpy(0.7, a.data(), plain_y.data(), n);
    plain.xpby(a.data(), -0.3, plain_y.data(), n);
    EXPECT_LT(relative_difference(y, plain_y), 1e-15);
  }
}

/// A chain of four nodes, 0-1-2-3, with blocks that dominate on the diagonal.
struct Chain {
  explicit Chain(int the_size) : size(the_size), lanes(size == 2 ? 2 : size == 3 ? 4 : 8) {
    const auto random = random_numbers(11 * static_cast<std::size_t>(size * size));
    blocks.assign(random.size() + static_cast<std::size_t>(lanes), 0.0F);
    std::ranges::transform(random, blocks.begin(), [](double number) { return static_cast<float>(number); });
    for (int node = 0; node < 4; ++node)
      for (int d = 0; d < size; ++d) blocks[static_cast<std::size_t>((node * size + d) * size + d)] += 4;
  }
  LevelView view() const {
    const int block = size * size;
    return {row_begin.data(), columns.data(), blocks.data() + 4 * block, blocks.data(),
            blocks.data() + 7 * block};
  }
  int size, lanes;
  std::vector<int64_t> row_begin = {0, 1, 2, 3, 3};
  std::vector<int32_t> columns = {1, 2, 3};
  std::vector<float> blocks;  // 4 of the diagonal, 3 above it, 4 that stand for the inverse of the diagonal
};

TEST_P(EveryInstructionSet, SmoothsAlike) {
  for (const auto [dim, kind, size] : {std::array{2, 0, 2}, {2, 1, 3}, {3, 0, 3}, {3, 1, 6}}) {
    const Chain chain(size);
    std::vector<float> results[2];
    const std::vector<double> start = random_numbers(static_cast<std::size_t>(4 * chain.lanes));
    for (const bool is_plain : {true, false}) {
      const MultigridKernels& set = is_plain ? plain_multigrid : multigrid;
      std::vector<float> r(start.begin(), start.end()), b = r, x(r.size()), y(r.size());
      constexpr NodeRange all = {0, 4};
      set.sweep_forward[dim - 2][kind](chain.view(), all, r.data(), x.data());
      set.negate_upper[dim - 2][kind](chain.view(), all, x.data(), r.data());
      set.subtract_lower[dim - 2][kind](chain.view(), all, x.data(), b.data());
      set.sweep_backward[dim - 2][kind](chain.view(), all, b.data(), x.data());
      set.multiply_add[dim - 2][kind](chain.view(), all, x.data(), y.data());
      for (int node = 0; node < 4; ++node)
        for (int d = 0; d < size; ++d) {
          const auto k = static_cast<std::size_t>(node * chain.lanes + d);
          for (const std::vector<float>* vector : {&r, &x, &y})
            results[is_plain ? 0 : 1].push_back((*vector)[k]);
        }
    }
    EXPECT_LT(relative_difference(results[0], results[1]), 1e-5) << size;
  }
}

}  // namespace
}  // namespace resilin::detail
