#include "resilin/linear/scalar_columns.hpp"

#include <algorithm>

namespace resilin {

// Block row i of the upper triangle is, transposed, block column i of the lower one. Column r of it holds the
// r-th rows of the blocks, less the r entries of the diagonal block that lie above the diagonal: entry (r, c)
// of its k-th block stands at first + r * stride - r (r + 1) / 2 + c, with first = begin of the block row + k
// * dim.

template <class Int>
void ScalarColumns<Int>::set_pattern(const MergedPattern& pattern, int dim) {
  begin.assign(1, 0);
  rows.clear();
  first_.clear();
  stride_.clear();
  is_diagonal_.clear();
  for (Index i = 0; i < pattern.num_nodes(); ++i) {
    const Offset row_begin = pattern.row_begin[i], row_end = pattern.row_begin[i + 1];
    for (Offset s = row_begin; s < row_end; ++s) {
      is_diagonal_.push_back(s == row_begin);
      first_.push_back(static_cast<Offset>(begin.back()) + (s - row_begin) * dim);
      stride_.push_back(static_cast<Index>((row_end - row_begin) * dim));
    }
    for (int r = 0; r < dim; ++r) {
      for (Offset s = row_begin; s < row_end; ++s)
        for (int c = s == row_begin ? r : 0; c < dim; ++c)
          rows.push_back(static_cast<Int>(pattern.columns[s]) * dim + c);
      begin.push_back(static_cast<Int>(rows.size()));
    }
  }
  values.resize(rows.size());
}

template <class Int>
void ScalarColumns<Int>::set_values(const MergedPattern& pattern, const BlockMatrix& A) {
  std::fill(values.begin(), values.end(), 0.0);
  const int dim = A.dim;
  const auto add = [&](Offset slot, const double* block, bool is_diagonal) {
    for (int r = 0; r < dim; ++r) {
      double* column = values.data() + first_[slot] + r * stride_[slot] - r * (r + 1) / 2;
      for (int c = is_diagonal ? r : 0; c < dim; ++c) column[c] += block[r * dim + c];
    }
  };
  pattern.for_each_block(A, [&](Offset slot, const double* block) { add(slot, block, is_diagonal_[slot]); });
}

template struct ScalarColumns<int>;
template struct ScalarColumns<std::int64_t>;

}  // namespace resilin
