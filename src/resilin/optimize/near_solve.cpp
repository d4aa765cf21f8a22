#include "resilin/optimize/near_solve.hpp"

namespace resilin {

std::optional<VectorX> solve_by_near(const Product& times, const NearSolve& near, const VectorX& b,
                                     double tolerance) {
  constexpr int most_iterations = 20;
  const double size = b.norm();
  VectorX p = VectorX::Zero(b.size()), residual = b, preconditioned, direction, product;
  if (size == 0) return p;
  double last = 1;
  for (int k = 0; k < most_iterations; ++k) {
    if (!near(residual, preconditioned)) return std::nullopt;
    const double along = residual.dot(preconditioned);
    if (!(along > 0)) return std::nullopt;
    direction = k == 0 ? preconditioned : VectorX(preconditioned + along / last * direction);
    times(direction, product);
    const double curvature = direction.dot(product);
    if (!(curvature > 0)) return std::nullopt;
    p += along / curvature * direction;
    residual -= along / curvature * product;
    last = along;
    if (residual.norm() <= tolerance * size) return p;
  }
  return std::nullopt;
}

}  // namespace resilin
