#include "resilin/linear/block_matrix.hpp"

#include <algorithm>
#include <cassert>
#include <cstdint>

#include "resilin/core/memory.hpp"
#include "resilin/core/parallel.hpp"
#include "resilin/linear/decoupled.hpp"
#include "resilin/linear/kernels/block_kernels.hpp"

namespace resilin {
namespace {

constexpr std::size_t gather_chunk = 4096;  // nodes
constexpr std::size_t numbers_per_chunk = 1 << 15;

void multiply_extra(const BlockMatrix& A, const VectorX& x, VectorX& y) {
  const int dim = A.dim;
  for (const BlockMatrix::ExtraBlock& extra : A.extra) {
    const double* block = A.extra_values.data() + extra.begin;
    for (int r = 0; r < dim; ++r)
      for (int c = 0; c < dim; ++c) {
        y[extra.row * dim + r] += block[r * dim + c] * x[extra.column * dim + c];
        if (extra.row != extra.column)
          y[extra.column * dim + c] += block[r * dim + c] * x[extra.row * dim + r];
      }
  }
}

/// A place for a pair in a table of 2^k places (Fibonacci hashing: Knuth 1998, 6.4).
std::size_t hashed(Index row, Index column, std::size_t num_places) {
  const auto key = static_cast<std::uint64_t>(row) << 32 | static_cast<std::uint32_t>(column);
  return static_cast<std::size_t>(key * 0x9e3779b97f4a7c15ULL >> 32) & (num_places - 1);
}

/// Row `row` of a dim x dim block becomes that of the identity, or of zero off the diagonal.
void clear_row(double* block, int dim, int row, double diagonal) {
  for (int c = 0; c < dim; ++c) block[row * dim + c] = c == row ? diagonal : 0;
}

void clear_column(double* block, int dim, int column, double diagonal) {
  for (int r = 0; r < dim; ++r) block[r * dim + column] = r == column ? diagonal : 0;
}

}  // namespace

BlockMatrix::BlockMatrix(int dimension, std::shared_ptr<const BlockPattern> fixed_pattern)
    : dim(dimension), pattern(std::move(fixed_pattern)) {
  assign_zeros(values, static_cast<std::size_t>(pattern->num_slots()) * dimension * dimension);
  assert(pattern->product_plan.num_chunks() > 0 && "the pattern is not complete");
}

void BlockMatrix::set_zero() {
  parallel_for(values.size(), numbers_per_chunk, [&](std::size_t begin, std::size_t end) {
    std::fill(values.begin() + static_cast<Offset>(begin), values.begin() + static_cast<Offset>(end), 0.0);
  });
  extra.clear();
  extra_values.clear();
  std::ranges::fill(extra_places_, -1);
}

void BlockMatrix::enlarge_places() {
  extra_places_.assign(std::max<std::size_t>(256, 2 * extra_places_.size()), -1);
  for (std::size_t k = 0; k < extra.size(); ++k) {
    std::size_t place = hashed(extra[k].row, extra[k].column, extra_places_.size());
    while (extra_places_[place] >= 0) place = (place + 1) & (extra_places_.size() - 1);
    extra_places_[place] = static_cast<Index>(k);
  }
}

double* BlockMatrix::extra_block(Index row, Index column) {
  if (2 * (extra.size() + 1) > extra_places_.size()) enlarge_places();
  std::size_t place = hashed(row, column, extra_places_.size());
  for (; extra_places_[place] >= 0; place = (place + 1) & (extra_places_.size() - 1)) {
    const ExtraBlock& found = extra[static_cast<std::size_t>(extra_places_[place])];
    if (found.row == row && found.column == column) return extra_values.data() + found.begin;
  }
  extra_places_[place] = static_cast<Index>(extra.size());
  extra.push_back({row, column, static_cast<Offset>(extra_values.size())});
  extra_values.resize(extra_values.size() + static_cast<std::size_t>(dim * dim), 0.0);
  return extra_values.data() + extra.back().begin;
}

void BlockMatrix::add_block(Index i, Index j, const double* block_values) {
  const Index row = std::min(i, j), column = std::max(i, j);
  const Offset slot = pattern->find_slot(row, column);
  double* to = slot < 0 ? extra_block(row, column) : block(slot);
  for (int r = 0; r < dim; ++r)
    for (int c = 0; c < dim; ++c)
      to[r * dim + c] += i <= j ? block_values[r * dim + c] : block_values[c * dim + r];
}

void BlockMatrix::add_to_diagonal(Index node, int component, double value) {
  block(pattern->row_begin[node])[component * (dim + 1)] += value;
}

void multiply(const BlockMatrix& A, const VectorX& x, VectorX& y) {
  std::vector<double> work;
  multiply(A, x, y, work);
}

void multiply(const BlockMatrix& A, const VectorX& x, VectorX& y, std::vector<double>& work) {
  const BlockPattern& pattern = *A.pattern;
  const BlockPattern::ProductPlan& plan = pattern.product_plan;
  const auto multiply_rows = detail::block_kernels().multiply_rows[A.dim - 2];
  const auto dim = static_cast<std::size_t>(A.dim);
  assert(x.size() == A.num_unknowns());
  y.resize(A.num_unknowns());
  if (plan.num_chunks() == 1) {
    y.setZero();
    multiply_rows(pattern.row_begin.data(), pattern.columns.data(), pattern.columns.data(), A.values.data(),
                  x.data(), y.data(), 0, A.num_nodes());
  } else {
    const auto num_nodes = static_cast<std::size_t>(A.num_nodes());
    work.resize((num_nodes + static_cast<std::size_t>(plan.chunk_places.back())) * dim);
    parallel_tasks(static_cast<std::size_t>(plan.num_chunks()), [&](std::size_t chunk) {
      const Index first = plan.chunk_begin[chunk], last = plan.chunk_begin[chunk + 1];
      std::fill(work.begin() + first * A.dim, work.begin() + last * A.dim, 0.0);
      const auto places = work.begin() + static_cast<Offset>(num_nodes * dim);
      std::fill(places + plan.chunk_places[chunk] * A.dim, places + plan.chunk_places[chunk + 1] * A.dim,
                0.0);
      multiply_rows(pattern.row_begin.data(), pattern.columns.data(), plan.targets.data(), A.values.data(),
                    x.data(), work.data(), first, last);
    });
    parallel_for(num_nodes, gather_chunk, [&](std::size_t begin, std::size_t end) {
      std::copy(work.begin() + static_cast<Offset>(begin * dim),
                work.begin() + static_cast<Offset>(end * dim), y.data() + begin * dim);
      for (std::size_t node = begin; node < end; ++node)
        for (Index k = plan.gather_begin[node]; k < plan.gather_begin[node + 1]; ++k) {
          const auto place = num_nodes + static_cast<std::size_t>(plan.gather_places[k]);
          for (std::size_t d = 0; d < dim; ++d)
            y[static_cast<Offset>(node * dim + d)] += work[place * dim + d];
        }
    });
  }
  multiply_extra(A, x, y);
}

void eliminate(BlockMatrix& A, std::span<const std::uint8_t> is_fixed) {
  const BlockPattern& pattern = *A.pattern;
  const int dim = A.dim;
  assert(is_fixed.size() == static_cast<std::size_t>(A.num_unknowns()));
  const std::vector<std::uint8_t> has_fixed = nodes_with_any(is_fixed, dim);
  const auto clear_in_row = [&](std::size_t node) {
    const Offset begin = pattern.row_begin[node], end = pattern.row_begin[node + 1];
    for (int d = 0; has_fixed[node] != 0 && d < dim; ++d)
      if (is_fixed[node * static_cast<std::size_t>(dim) + static_cast<std::size_t>(d)] != 0)
        for (Offset s = begin; s < end; ++s) clear_row(A.block(s), dim, d, s == begin ? 1 : 0);
    for (Offset s = begin; s < end; ++s)
      for (int d = 0; has_fixed[pattern.columns[s]] != 0 && d < dim; ++d)
        if (is_fixed[Offset{pattern.columns[s]} * dim + d] != 0)
          clear_column(A.block(s), dim, d, s == begin ? 1 : 0);
  };
  parallel_for(has_fixed.size(), gather_chunk, [&](std::size_t first, std::size_t last) {
    for (std::size_t node = first; node < last; ++node) clear_in_row(node);
  });
  for (const BlockMatrix::ExtraBlock& extra : A.extra) {
    double* block = A.extra_values.data() + extra.begin;
    for (int d = 0; d < dim; ++d) {
      if (is_fixed[extra.row * dim + d]) clear_row(block, dim, d, 0);
      if (is_fixed[extra.column * dim + d]) clear_column(block, dim, d, 0);
    }
  }
}

}  // namespace resilin
