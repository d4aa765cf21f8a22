#pragma once

#include <cstdint>
#include <vector>

#include "resilin/linear/merged_pattern.hpp"

namespace resilin {

/// The lower triangle by scalar columns (compressed, rows ascending): the format of general sparse
/// factorisations.
template <class Int>
struct ScalarColumns {
  std::vector<Int> begin;  ///< num_unknowns + 1
  std::vector<Int> rows;
  std::vector<double> values;

  void set_pattern(const MergedPattern& pattern, int dim);
  void set_values(const MergedPattern& pattern, const BlockMatrix& A);

 private:
  std::vector<Offset> first_;              // by slot: where entry (0, 0) of the block stands
  std::vector<std::uint8_t> is_diagonal_;  // by slot
  std::vector<Index> stride_;              // by slot: length of the first column of its block row
};

extern template struct ScalarColumns<int>;
extern template struct ScalarColumns<std::int64_t>;

}  // namespace resilin
