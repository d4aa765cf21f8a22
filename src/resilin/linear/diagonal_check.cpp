#include "resilin/linear/diagonal_check.hpp"

#include <algorithm>

#include "resilin/linear/small_block.hpp"

namespace resilin {

DiagonalCheck check_diagonal(const BlockMatrix& A) {
  constexpr double round_off = 1e-14;
  DiagonalCheck check;
  double inverse[9];
  for (Index i = 0; i < A.num_nodes(); ++i) {
    const double* block = A.block(A.pattern->row_begin[i]);
    for (int d = 0; d < A.dim; ++d) check.largest = std::max(check.largest, block[d * (A.dim + 1)]);
    const bool is_definite = A.dim == 3 ? invert_positive_definite<3>(block, round_off, inverse)
                                        : invert_positive_definite<2>(block, round_off, inverse);
    if (!is_definite && check.bad_node < 0) check.bad_node = i;
  }
  return check;
}

}  // namespace resilin
