#pragma once

#include <array>

#include "resilin/core/types.hpp"

/// Strains and principal values at one point. H = F - I is the displacement gradient, in plane strain with
/// zeros in its third row and column.
namespace resilin {

/// E = (F^T F - I) / 2 = (H + H^T + H^T H) / 2, in the axes of the rest shape.
Matrix<3> green_strain(const Matrix<3>& H);

/// ln V = ln(F F^T) / 2, in the axes of the deformed shape; without loss of digits at small strain.
Matrix<3> logarithmic_strain(const Matrix<3>& H);

/// Eigenvalues and eigenvectors of a symmetric tensor.
struct Principal {
  std::array<double, 3> values;  ///< from the largest to the smallest
  Matrix<3> directions;          ///< columns of length 1, the component of largest size positive
};
/// Principal values of a symmetric tensor; not numbers when it holds one that is none.
Principal principal(const Matrix<3>& tensor);

}  // namespace resilin
