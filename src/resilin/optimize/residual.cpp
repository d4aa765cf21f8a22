#include "resilin/optimize/residual.hpp"

#include <cmath>
#include <limits>

namespace resilin {

void set_fixed_to_zero(std::span<const std::uint8_t> is_fixed, VectorX& values) {
  for (Eigen::Index i = 0; i < values.size(); ++i) {
    if (is_fixed[static_cast<std::size_t>(i)] != 0) values[i] = 0;
  }
}

VectorX free_diagonal(const BlockMatrix& hessian, std::span<const std::uint8_t> is_fixed) {
  VectorX diagonal(hessian.num_unknowns());
  for (Eigen::Index i = 0; i < diagonal.size(); ++i) {
    const auto node = static_cast<std::size_t>(i / hessian.dim);
    const auto k = static_cast<int>(i % hessian.dim);
    diagonal[i] = std::abs(hessian.block(hessian.pattern->row_begin[node])[k * (hessian.dim + 1)]);
  }
  set_fixed_to_zero(is_fixed, diagonal);
  return diagonal;
}

Residual free_residual(const VectorX& gradient, std::span<const std::uint8_t> is_fixed) {
  Residual residual;
  double sum = 0;
  double worst = -1;
  for (Eigen::Index i = 0; i < gradient.size(); ++i) {
    if (is_fixed[static_cast<std::size_t>(i)] != 0) continue;
    sum += gradient[i] * gradient[i];
    if (std::abs(gradient[i]) > worst) {
      worst = std::abs(gradient[i]);
      residual.worst = static_cast<Index>(i);
    }
  }
  residual.norm = std::sqrt(sum);
  return residual;
}

double residual_round_off(const Objective& objective, std::span<const std::uint8_t> is_fixed,
                          const VectorX& x, const VectorX& diagonal) {
  VectorX magnitude;
  objective.gradient_magnitude(x, magnitude);
  if (diagonal.size() == x.size()) magnitude += diagonal.cwiseProduct(x.cwiseAbs());
  set_fixed_to_zero(is_fixed, magnitude);
  return 10 * std::numeric_limits<double>::epsilon() * magnitude.norm();
}

}  // namespace resilin
