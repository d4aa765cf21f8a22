#pragma once

#include <memory>
#include <vector>

#include "resilin/linear/block_matrix.hpp"

namespace resilin {

/// A few numbers of every row of a matrix, by which another matrix is found near to it or not: what the
/// diagonal holds sees pairs that come and go, a row of the block beside it sees rotations.
class MatrixSample {
 public:
  void take(const BlockMatrix& A);
  void forget() { pattern_.reset(); }

  /// Whether A has the pattern of the matrix that was taken and no number of the sample has changed by more
  /// than `share` of the diagonal of its node; extra blocks are seen by what they add to the diagonal.
  bool is_near(const BlockMatrix& A, double share) const;

 private:
  std::shared_ptr<const BlockPattern> pattern_;  // null: nothing was taken
  std::vector<float> numbers_;                   // 2 dim for each node
  double scale_ = 1;                             // brings them into the range of float
};

}  // namespace resilin
