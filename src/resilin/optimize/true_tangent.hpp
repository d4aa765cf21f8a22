#pragma once

#include <cstdint>
#include <span>

#include "resilin/optimize/near_solve.hpp"
#include "resilin/optimize/objective.hpp"

namespace resilin {

/// Result of a solve with the true, nonsymmetric tangent.
struct TangentReport {
  int iterations = 0;
  double relative_residual = 1;  ///< |b - J p| / |b|
};

/// Solves J p = b with J the derivative of the gradient at x, also where that is not symmetric because the
/// forces have no potential (a pressure that follows an open surface). GMRES (Saad & Schultz 1986) with
/// `near` as preconditioner from the right; J p is a central difference of the gradient, exact for the
/// pressure, which is quadratic in x. `b` and `p` are zero at fixed unknowns.
///
/// Cost of an iteration: two gradients and one solve with `near`.
TangentReport solve_with_true_tangent(const Objective& objective, std::span<const std::uint8_t> is_fixed,
                                      const ProcessGroup& share, const VectorX& x, const VectorX& b,
                                      const NearSolve& near, double tolerance, VectorX& p);

}  // namespace resilin
