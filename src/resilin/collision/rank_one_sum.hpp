#pragma once

#include <array>
#include <cmath>

#include "resilin/collision/pair_kind.hpp"
#include "resilin/core/projection.hpp"
#include "resilin/core/types.hpp"

namespace resilin {

/// Fixed-size vectors and matrices over the vertices of a pair.
template <int dim>
struct PairSpace {
  static constexpr int size = most_pair_vertices * dim;
  using Vector = Eigen::Matrix<double, size, 1>;
  using Matrix = Eigen::Matrix<double, size, size>;
};

/// One number per coordinate of a pair, vertex by vertex; zero for vertices that the pair does not have.
template <int dim>
using PairVector = typename PairSpace<dim>::Vector;
template <int dim>
using PairMatrix = typename PairSpace<dim>::Matrix;

/// A symmetric matrix of a pair, kept as sum_k factor_k u_k u_k^T, so that its projection needs no
/// eigenvalues: each factor is dealt with by itself. What is left is positive semidefinite, and where the u_k
/// are orthogonal it is the nearest such matrix.
template <int dim>
class RankOneSum {
 public:
  void add(double factor, const PairVector<dim>& u) {
    factors_[count_] = factor;
    vectors_[count_++] = u;
  }

  PairMatrix<dim> matrix(Projection projection) const {
    PairMatrix<dim> sum = PairMatrix<dim>::Zero();
    for (std::size_t k = 0; k < count_; ++k) {
      double factor = factors_[k];
      if (projection == Projection::clamp && factor < 0) factor = 0;
      if (projection == Projection::absolute) factor = std::abs(factor);
      if (factor != 0) sum.noalias() += (factor * vectors_[k]) * vectors_[k].transpose();
    }
    sum.template triangularView<Eigen::StrictlyUpper>() = sum.transpose();  // to the last bit
    return sum;
  }

 private:
  static constexpr std::size_t most_terms = 16;  ///< a mollified pair of edges has 15

  std::array<double, most_terms> factors_;
  std::array<PairVector<dim>, most_terms> vectors_;
  std::size_t count_ = 0;
};

}  // namespace resilin
