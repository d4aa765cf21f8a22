#pragma once

#include <cmath>

#include "resilin/core/types.hpp"

namespace resilin {

/// Inverts the symmetric positive definite row-major block by its Cholesky factor; the lower triangle is
/// read. False when a pivot is not above `least_pivot`, a fraction of the largest entry of the diagonal.
template <int dim>
bool invert_positive_definite(const double* block, double least_pivot, double* inverse) {
  double L[dim][dim];
  double scale = 0;
  for (int d = 0; d < dim; ++d) scale = block[d * (dim + 1)] > scale ? block[d * (dim + 1)] : scale;
  for (int c = 0; c < dim; ++c) {
    double pivot = block[c * (dim + 1)];
    for (int k = 0; k < c; ++k) pivot -= L[c][k] * L[c][k];
    if (!(pivot > least_pivot * scale) || !(scale < 1e300)) return false;
    L[c][c] = std::sqrt(pivot);
    for (int r = c + 1; r < dim; ++r) {
      double sum = block[r * dim + c];
      for (int k = 0; k < c; ++k) sum -= L[r][k] * L[c][k];
      L[r][c] = sum / L[c][c];
    }
  }
  double inverse_L[dim][dim] = {};
  for (int c = 0; c < dim; ++c) {
    inverse_L[c][c] = 1 / L[c][c];
    for (int r = c + 1; r < dim; ++r) {
      double sum = 0;
      for (int k = c; k < r; ++k) sum -= L[r][k] * inverse_L[k][c];
      inverse_L[r][c] = sum / L[r][r];
    }
  }
  for (int r = 0; r < dim; ++r)
    for (int c = 0; c <= r; ++c) {
      double sum = 0;
      for (int k = r; k < dim; ++k) sum += inverse_L[k][r] * inverse_L[k][c];
      inverse[r * dim + c] = inverse[c * dim + r] = sum;
    }
  return true;
}

}  // namespace resilin
