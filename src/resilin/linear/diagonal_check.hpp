#pragma once

#include "resilin/linear/block_matrix.hpp"

namespace resilin {

/// Checks of a matrix before a preconditioner uses it.
struct DiagonalCheck {
  double largest = 0;  ///< entry of the diagonal
  Index bad_node =
      -1;  ///< the first one whose diagonal block is not positive definite: neither is the matrix
};

/// Looks at the diagonal blocks of a symmetric matrix.
DiagonalCheck check_diagonal(const BlockMatrix& A);

}  // namespace resilin
