#pragma once

#include "resilin/linear/block_matrix.hpp"

namespace resilin {

/// What a preconditioner wants to know of a matrix before it starts.
struct DiagonalCheck {
  double largest = 0;  ///< entry of the diagonal
  Index bad_node =
      -1;  ///< the first one whose diagonal block is not positive definite: neither is the matrix
};

DiagonalCheck check_diagonal(const BlockMatrix& A);

}  // namespace resilin
