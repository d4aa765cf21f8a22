#include "resilin/core/determinant.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>

namespace resilin {
namespace {

/// The determinant is a polynomial of degree two along a line in 2D and three in 3D: with this step, central
/// differences are exact but for a term of its square.
template <int dim>
void expect_differences() {
  constexpr double step = 1e-5;
  Matrix<dim> F = Matrix<dim>::Identity();
  for (int i = 0; i < dim; ++i)
    for (int j = 0; j < dim; ++j) F(i, j) += 0.3 * i - 0.2 * j + 0.1 * i * j;
  const auto hessian = determinant_hessian<dim>(F);
  for (int k = 0; k < dim * dim; ++k) {
    Matrix<dim> ahead = F, behind = F;
    ahead.data()[k] += step;
    behind.data()[k] -= step;
    EXPECT_NEAR(cofactor<dim>(F).data()[k], (ahead.determinant() - behind.determinant()) / (2 * step), 1e-9);
    const Matrix<dim> slopes = (cofactor<dim>(ahead) - cofactor<dim>(behind)) / (2 * step);
    for (int l = 0; l < dim * dim; ++l) EXPECT_NEAR(hessian(l, k), slopes.data()[l], 1e-9);
  }
}

TEST(Determinant, HasTheDerivativesOfItsDifferences) {
  expect_differences<2>();
  expect_differences<3>();
}

}  // namespace
}  // namespace resilin
