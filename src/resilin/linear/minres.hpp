#pragma once

#include <functional>

#include "resilin/core/types.hpp"

namespace resilin {

/// Limits of MINRES.
struct MinresSettings {
  int max_iterations = 100;
  double tolerance =
      1e-6;  ///< largest residual, in the norm of the preconditioner, relative to the right side
};

/// Solves A x = b by the minimum residual method, for a symmetric A that may be indefinite: a saddle point.
/// @param apply         image = A v; false stops
/// @param precondition  image = M^-1 v, with M symmetric and positive definite
/// @return              whether the tolerance was reached; x is the best approximation found in any case
/// Source: Paige & Saunders 1975; Elman, Silvester & Wathen 2014, alg. 4.1.
bool minres(const std::function<bool(const VectorX& v, VectorX& image)>& apply,
            const std::function<void(const VectorX& v, VectorX& image)>& precondition, const VectorX& b,
            const MinresSettings& settings, VectorX& x);

}  // namespace resilin
