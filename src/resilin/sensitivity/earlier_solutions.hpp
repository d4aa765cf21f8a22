#pragma once

#include <vector>

#include "resilin/linear/block_matrix.hpp"

namespace resilin {

/// The last solutions of a sequence of equations whose matrices and right sides change little from one to the
/// next, as those of adjoints from step to step: where an iteration for the next one may begin.
class EarlierSolutions {
 public:
  /// Their combination that is nearest to the solution of A p = b in the norm of A, for A positive definite;
  /// empty where that is no nearer than nothing. Fischer 1998, Projection techniques for iterative solution
  /// of Ax = b with successive right-hand sides, on solutions of matrices that are near to A.
  VectorX nearest(const BlockMatrix& A, const VectorX& b) const;
  void take(VectorX solution);

 private:
  /// Measured on cubes and bars in motion: with 3 an iteration is a tenth longer, 12 take as long.
  static constexpr std::size_t most_kept = 8;

  std::vector<VectorX> solutions_;  ///< the last one first
};

}  // namespace resilin
