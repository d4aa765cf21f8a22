#pragma once

#include <vector>

#include "resilin/core/types.hpp"

namespace resilin {

/// Rows of a pattern, one after another, that a thread has found of those that many look for
/// (parallel_in_order).
struct FoundRows {
  std::vector<Index> columns;
  std::vector<Offset> ends;  ///< ends of each row, in `columns`

  void end_row() { ends.push_back(static_cast<Offset>(columns.size())); }

  /// @param begin_of_row  of all rows, with the end of the last one behind
  template <class Place>
  void append_to(std::vector<Place>& begin_of_row, std::vector<Index>& all) const {
    const auto begin = static_cast<Offset>(all.size());
    for (const Offset end : ends) begin_of_row.push_back(static_cast<Place>(begin + end));
    all.insert(all.end(), columns.begin(), columns.end());
  }
};

}  // namespace resilin
