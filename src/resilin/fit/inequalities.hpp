#pragma once

#include "resilin/fit/predicted_values.hpp"

namespace resilin {

/// min |E u - f|, u >= 0. Source: Lawson & Hanson 1974, algorithm NNLS (23.10).
VectorX nonnegative_least_squares(const DenseMatrix& E, const VectorX& f);

/// min |A x - b| with G x >= h, for an A of full column rank. Source: Lawson & Hanson 1974, LSI (23.4) by LDP
/// (23.27).
struct BoundedStep {
  VectorX x;
  VectorX multipliers;  ///< >= 0, of the rows of G, for half the square
};
/// False when no x satisfies the inequalities.
bool least_squares_with_inequalities(const DenseMatrix& A, const VectorX& b, const DenseMatrix& G,
                                     const VectorX& h, BoundedStep& step);

}  // namespace resilin
