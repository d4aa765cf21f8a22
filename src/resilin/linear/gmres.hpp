#pragma once

#include <functional>

#include "resilin/core/types.hpp"

namespace resilin {

/// Result of GMRES.
struct GmresReport {
  VectorX x;
  double left = 1;  ///< |b - A x| / |b|, as the projected problem has it
  int products = 0;
};

/// Solves A x = b from zero by GMRES without restart, A known by its products alone.
/// Source: Saad & Schultz 1986.
/// @param tolerance     of |b - A x| / |b|, at which it stops
/// @param most          products
/// @param precondition  from the right, near the inverse of A; none: the identity
GmresReport gmres(const std::function<VectorX(const VectorX&)>& product, const VectorX& b, double tolerance,
                  int most, const std::function<VectorX(const VectorX&)>& precondition = {});

}  // namespace resilin
