#pragma once

#include "resilin/core/types.hpp"

namespace resilin {

/// dJ/dF of J = det F.
template <int dim>
Matrix<dim> cofactor(const Matrix<dim>& F) {
  static_assert(dim == 2 || dim == 3);
  Matrix<dim> result;
  if constexpr (dim == 2) {
    result << F(1, 1), -F(1, 0), -F(0, 1), F(0, 0);
  } else {
    for (int j = 0; j < 3; ++j)
      for (int i = 0; i < 3; ++i) {
        const int k = (i + 1) % 3, m = (i + 2) % 3, l = (j + 1) % 3, n = (j + 2) % 3;
        result(i, j) = F(k, l) * F(m, n) - F(m, l) * F(k, n);
      }
  }
  return result;
}

/// d2J/dF2 of J = det F, with vec(F) by columns.
template <int dim>
Eigen::Matrix<double, dim * dim, dim * dim> determinant_hessian(const Matrix<dim>& F) {
  static_assert(dim == 2 || dim == 3);
  Eigen::Matrix<double, dim * dim, dim * dim> D = Eigen::Matrix<double, dim * dim, dim * dim>::Zero();
  const auto set = [&D](int i, int j, int k, int l, double value) { D(i + dim * j, k + dim * l) = value; };
  if constexpr (dim == 2) {
    for (const int i : {0, 1})
      for (const int j : {0, 1}) set(i, j, 1 - i, 1 - j, i == j ? 1 : -1);
  } else {
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) {  // cof_ij = F_kl F_mn - F_kn F_ml
        const int k = (i + 1) % 3, m = (i + 2) % 3, l = (j + 1) % 3, n = (j + 2) % 3;
        set(i, j, k, l, F(m, n));
        set(i, j, m, n, F(k, l));
        set(i, j, k, n, -F(m, l));
        set(i, j, m, l, -F(k, n));
      }
  }
  return D;
}

}  // namespace resilin
