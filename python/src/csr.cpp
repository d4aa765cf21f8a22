#include "csr.hpp"

#include <algorithm>
#include <limits>
#include <numeric>
#include <string>

#include "resilin/core/error.hpp"
#include "resilin/core/parallel.hpp"

namespace resilin::python {
namespace {

constexpr std::size_t nodes_per_chunk = 1024;

/// Blocks left of the diagonal in each row: the transposed blocks of slots (j, i), j < i, j ascending.
struct LowerBlocks {
  std::vector<Offset> begin, slots;
  std::vector<Index> columns;

  explicit LowerBlocks(const BlockPattern& pattern) : begin(pattern.row_begin.size(), 0) {
    const auto for_each = [&](const auto& visit) {
      for (Index j = 0; j < pattern.num_nodes(); ++j)
        for (Offset s = pattern.row_begin[static_cast<std::size_t>(j)] + 1;
             s < pattern.row_begin[static_cast<std::size_t>(j) + 1]; ++s)
          visit(static_cast<std::size_t>(pattern.columns[static_cast<std::size_t>(s)]), j, s);
    };
    for_each([&](std::size_t i, Index, Offset) { ++begin[i + 1]; });
    std::partial_sum(begin.begin(), begin.end(), begin.begin());
    slots.resize(static_cast<std::size_t>(begin.back()));
    columns.resize(slots.size());
    std::vector<Offset> next = begin;
    for_each([&](std::size_t i, Index j, Offset s) {
      const auto place = static_cast<std::size_t>(next[i]++);
      slots[place] = s;
      columns[place] = j;
    });
  }
};

/// Blocks in the row of a node: those left of the diagonal, the diagonal and those right of it.
Offset num_blocks(const BlockPattern& pattern, const LowerBlocks& lower, std::size_t node) {
  return lower.begin[node + 1] - lower.begin[node] + pattern.row_begin[node + 1] - pattern.row_begin[node];
}

}  // namespace

Csr to_csr(const BlockMatrix& matrix) {
  const BlockPattern& pattern = *matrix.pattern;
  const auto num_nodes = static_cast<std::size_t>(pattern.num_nodes());
  const auto dim = static_cast<std::size_t>(matrix.dim);
  const LowerBlocks lower(pattern);
  const Offset num_entries = (2 * pattern.num_slots() - pattern.num_nodes()) * matrix.dim * matrix.dim;
  if (num_entries > std::numeric_limits<Index>::max())
    throw InputError("hessian", "at most 2147483647 entries", std::to_string(num_entries));
  Csr csr;
  csr.row_begin.assign(num_nodes * dim + 1, 0);
  for (std::size_t i = 0; i < num_nodes; ++i)
    for (std::size_t a = 0; a < dim; ++a)
      csr.row_begin[i * dim + a + 1] =
          csr.row_begin[i * dim + a] + static_cast<Index>(matrix.dim * num_blocks(pattern, lower, i));
  csr.columns.resize(static_cast<std::size_t>(csr.row_begin.back()));
  csr.values.resize(csr.columns.size());
  parallel_for(num_nodes, nodes_per_chunk, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      std::size_t place = 0;  // place of the block in the row, in numbers
      const auto put = [&](Index column, const double* block, std::size_t row_stride,
                           std::size_t column_stride) {
        for (std::size_t a = 0; a < dim; ++a) {
          const std::size_t at = static_cast<std::size_t>(csr.row_begin[i * dim + a]) + place;
          for (std::size_t b = 0; b < dim; ++b) {
            csr.columns[at + b] = column * static_cast<Index>(dim) + static_cast<Index>(b);
            csr.values[at + b] = block[a * row_stride + b * column_stride];
          }
        }
        place += dim;
      };
      for (auto k = static_cast<std::size_t>(lower.begin[i]);
           k < static_cast<std::size_t>(lower.begin[i + 1]); ++k)
        put(lower.columns[k], matrix.block(lower.slots[k]), 1, dim);
      for (Offset slot = pattern.row_begin[i]; slot < pattern.row_begin[i + 1]; ++slot)
        put(pattern.columns[static_cast<std::size_t>(slot)], matrix.block(slot), dim, 1);
    }
  });
  return csr;
}

CsrArrays arrays_of(Csr csr) {
  const std::size_t count = csr.values.size(), rows = csr.row_begin.size();
  return {numpy_array(std::move(csr.values), {count}), numpy_array(std::move(csr.columns), {count}),
          numpy_array(std::move(csr.row_begin), {rows})};
}

}  // namespace resilin::python
