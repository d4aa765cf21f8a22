#include "resilin/linear/diagonal_check.hpp"

#include <algorithm>

#include "resilin/core/parallel.hpp"
#include "resilin/linear/small_block.hpp"

namespace resilin {

DiagonalCheck check_diagonal(const BlockMatrix& A) {
  constexpr double round_off = 1e-14;
  constexpr std::size_t nodes_per_chunk = 2048;
  struct Check : DiagonalCheck {
    Check& operator+=(const Check& later) {
      largest = std::max(largest, later.largest);
      if (bad_node < 0) bad_node = later.bad_node;
      return *this;
    }
  };
  return parallel_sum<Check>(
      static_cast<std::size_t>(A.num_nodes()), nodes_per_chunk, [&](std::size_t begin, std::size_t end) {
        Check check;
        double inverse[9];
        for (std::size_t i = begin; i < end; ++i) {
          const double* block = A.block(A.pattern->row_begin[i]);
          for (int d = 0; d < A.dim; ++d) check.largest = std::max(check.largest, block[d * (A.dim + 1)]);
          const bool is_definite = A.dim == 3 ? invert_positive_definite<3>(block, round_off, inverse)
                                              : invert_positive_definite<2>(block, round_off, inverse);
          if (!is_definite && check.bad_node < 0) check.bad_node = static_cast<Index>(i);
        }
        return check;
      });
}

}  // namespace resilin
