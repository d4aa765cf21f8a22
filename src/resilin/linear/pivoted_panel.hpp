#pragma once

#include <vector>

#include "resilin/linear/trapezoid.hpp"

namespace resilin::detail {

/// Smallest pivot of a matrix with largest entries of about one.
struct PivotRule {
  double threshold = 0.01;   ///< entries of L stay below its inverse
  double growth = 100;       ///< most that one pivot may add to an entry
  double round_off = 1e-14;  ///< smaller entries count as zero
};

/// L D L^T of the fully summed columns of a front, in the order in which pivots of one and two columns were
/// chosen.
struct PivotedColumns {
  int num_eliminated = 0;
  std::vector<int> order;        ///< by place in the panel: the column that was there before
  std::vector<double> diagonal;  ///< diagonal of D, by eliminated place
  std::vector<double> lower;     ///< lower of D, below the first column of a pair; zero elsewhere
  int null_column = -1;          ///< as before: one that vanishes, so that the matrix is singular

  int num_negative() const;  ///< eigenvalues of D
};

/// panel = [L11; L21] of the columns eliminated, with the zeros and ones of L11 on and below its diagonal;
/// the columns that no pivot was found for stand after them, updated: a parent has more rows to choose from.
/// Without rows below (num_rows = 0) there is always a pivot, unless a column is null.
///
/// Sources: Duff & Reid 1983 and Duff 2004 (threshold pivots of one and two columns, delayed ones); Bunch &
/// Kaufman 1977, Ashcraft, Grimes & Lewis 1998 (bounded L); Anderson et al. 1999, LAPACK's dlasyf (blocks,
/// columns brought up to date when they are looked at).
PivotedColumns ldlt_panel(int num_columns, int num_rows, double* panel, int stride, const PivotRule& rule);

/// Whether L L^T of a panel, as `cholesky_panel` leaves it, has added no more than the rule lets a pivot add:
/// then the factorisation is stable, though the matrix may have negative eigenvalues elsewhere.
bool is_bounded(int num_columns, const Trapezoid& panel, const PivotRule& rule);

/// rows D, one column after the other, where `rows` is L21.
std::vector<double> times_diagonal(int num_rows, const PivotedColumns& columns, const double* rows,
                                   int stride);

/// target = - left right^T, of `width` columns each.
void negative_product(int num_rows, int num_columns, int width, const double* left, int left_stride,
                      const double* right, int right_stride, double* target, int target_stride);

/// x = D^-1 x.
void solve_diagonal(const PivotedColumns& columns, double* x);

}  // namespace resilin::detail
