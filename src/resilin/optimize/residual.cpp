#include "resilin/optimize/residual.hpp"

#include <cmath>

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

}  // namespace resilin
