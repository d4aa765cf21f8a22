#pragma once

#include "resilin/core/types.hpp"

namespace resilin {

/// Columns of a lower triangle, or the first of them, in blocks that begin at their diagonal: column-major
/// trapezoids one after the other.
struct TrapezoidLayout {
  /// Width of a block in nodes, so that none is split.
  static constexpr Index nodes_per_block = 48;

  int order = 0;        ///< rows
  int block_width = 1;  ///< columns of a block

  int first_of_block(int column) const { return column / block_width * block_width; }
  int stride(int column) const { return order - first_of_block(column); }
  /// Where row 0 of a column would be: the rows from its block on are there.
  Offset column_begin(int column) const {
    const Offset first = first_of_block(column), num_blocks = first / block_width;
    const Offset blocks_before =
        first * order - static_cast<Offset>(block_width) * block_width * (num_blocks * (num_blocks - 1) / 2);
    return blocks_before + (column - first) * (order - first) - first;
  }
  Offset size(int num_columns) const {
    const int first = first_of_block(num_columns);
    return column_begin(first) + first + static_cast<Offset>(num_columns - first) * (order - first);
  }
};

/// A lower triangle, or its first columns, with their values.
struct Trapezoid {
  TrapezoidLayout layout;
  double* values = nullptr;

  /// Row 0 of a column: those from its block on are there.
  double* column(int j) const { return values + layout.column_begin(j); }
};

}  // namespace resilin
