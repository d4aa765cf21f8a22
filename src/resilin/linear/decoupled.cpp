#include "resilin/linear/decoupled.hpp"

#include "resilin/core/parallel.hpp"

namespace resilin {

std::vector<std::uint8_t> nodes_with_any(std::span<const std::uint8_t> of_unknowns, int dim) {
  std::vector<std::uint8_t> any(of_unknowns.size() / static_cast<std::size_t>(dim), 0);
  const std::uint8_t* next = of_unknowns.data();
  for (std::uint8_t& of_node : any)
    for (int d = 0; d < dim; ++d) of_node |= *next++;
  return any;
}

std::vector<std::uint8_t> decoupled_unknowns(const BlockMatrix& A) {
  const int dim = A.dim;
  const BlockPattern& pattern = *A.pattern;
  std::vector<std::uint8_t> is_fixed(static_cast<std::size_t>(A.num_unknowns()), 1);
  const auto look_at_row = [&](const double* block, int r, int diagonal, std::uint8_t& fixed) {
    for (int c = 0; c < dim; ++c)
      if (block[r * dim + c] != 0 && c != diagonal) fixed = 0;
  };
  const auto look_at_column = [&](const double* block, int c, std::uint8_t& fixed) {
    for (int r = 0; r < dim; ++r)
      if (block[r * dim + c] != 0) fixed = 0;
  };
  constexpr int none = -1;
  constexpr std::size_t nodes_per_chunk = 2048;
  parallel_for(
      static_cast<std::size_t>(A.num_nodes()), nodes_per_chunk, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i)
          for (int d = 0; d < dim; ++d) {
            std::uint8_t& fixed = is_fixed[i * dim + d];
            look_at_row(A.block(pattern.row_begin[i]), d, d, fixed);
            for (Offset s = pattern.row_begin[i] + 1; fixed != 0 && s < pattern.row_begin[i + 1]; ++s)
              look_at_row(A.block(s), d, none, fixed);
          }
      });
  // Few are left, to be looked for in the rows of nodes before them.
  const std::vector<std::uint8_t> is_left = nodes_with_any(is_fixed, dim);
  std::vector<std::vector<Offset>> coupled(is_left.size() / nodes_per_chunk + 1);
  const auto look_in_row = [&](std::size_t i, std::vector<Offset>& found) {
    for (Offset s = pattern.row_begin[i] + 1; s < pattern.row_begin[i + 1]; ++s) {
      if (is_left[pattern.columns[s]] == 0) continue;
      for (int d = 0; d < dim; ++d) {
        const Offset unknown = Offset{pattern.columns[s]} * dim + d;
        std::uint8_t fixed = is_fixed[unknown];
        look_at_column(A.block(s), d, fixed);
        if (fixed != is_fixed[unknown]) found.push_back(unknown);
      }
    }
  };
  parallel_for(is_left.size(), nodes_per_chunk, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) look_in_row(i, coupled[first / nodes_per_chunk]);
  });
  for (const std::vector<Offset>& unknowns : coupled)
    for (const Offset unknown : unknowns) is_fixed[unknown] = 0;
  for (const BlockMatrix::ExtraBlock& extra : A.extra) {
    const double* block = A.extra_values.data() + extra.begin;
    for (int d = 0; d < dim; ++d) {
      look_at_row(block, d, extra.row == extra.column ? d : none, is_fixed[extra.row * dim + d]);
      if (extra.row != extra.column) look_at_column(block, d, is_fixed[extra.column * dim + d]);
    }
  }
  return is_fixed;
}

}  // namespace resilin
