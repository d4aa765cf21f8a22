#pragma once

#include "resilin/core/types.hpp"
#include "resilin/linear/trapezoid.hpp"

namespace resilin::detail {

/// Dense kernels of a front, by BLAS and LAPACK. A panel has the columns that are eliminated, L11, and the
/// rows below them, L21.

/// panel = [L11; L21] of the Cholesky factorisation of its columns. Returns the first column whose pivot is
/// not positive, or -1.
int cholesky_panel(int num_columns, const Trapezoid& panel);

/// Lower trapezoid of target = beta target - rows first_rows^T: `num_columns` columns of `num_rows` rows,
/// where first_rows are the first of `rows`, which have `width` columns.
void subtract_products(int num_columns, int num_rows, int width, const double* rows, int stride, double beta,
                       double* target, int target_stride);

/// x = L11^-1 x, work -= L21 x.
void solve_panel(int num_columns, const Trapezoid& panel, double* x, double* work);

/// x = L11^-T (x - L21^T work).
void solve_panel_transposed(int num_columns, const Trapezoid& panel, double* x, const double* work);

/// Adds the part below the diagonal of a column of a child's update matrix to a column of its parent.
/// `places` are block rows of the parent; block rows [first, num_rows) of the child are added whole.
inline void add_rows(int dim, const double* from, const Index* places, Index first, Index num_rows,
                     double* to) {
  if (dim == 3) {
    for (Index k = first; k < num_rows; ++k) {
      double* target = to + static_cast<Offset>(places[k]) * 3;
      const double* source = from + static_cast<Offset>(k) * 3;
      target[0] += source[0];
      target[1] += source[1];
      target[2] += source[2];
    }
  } else {
    for (Index k = first; k < num_rows; ++k) {
      double* target = to + static_cast<Offset>(places[k]) * 2;
      const double* source = from + static_cast<Offset>(k) * 2;
      target[0] += source[0];
      target[1] += source[1];
    }
  }
}

}  // namespace resilin::detail
