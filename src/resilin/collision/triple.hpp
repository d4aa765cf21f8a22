#pragma once

// Vectors of three on a generic real type, a double or the lanes of an instruction set (core/simd.hpp), so
// that one text serves a single pair and a batch of them. Always inlined: see core/simd.hpp.

#include "resilin/core/simd.hpp"

namespace resilin {

/// a where the condition holds, else b.
RESILIN_INLINE double select(bool condition, double a, double b) { return condition ? a : b; }

/// A vector with three components.
template <class Real>
struct Triple {
  Real x[3];

  friend RESILIN_INLINE Triple operator+(const Triple& a, const Triple& b) {
    return {{a.x[0] + b.x[0], a.x[1] + b.x[1], a.x[2] + b.x[2]}};
  }
  friend RESILIN_INLINE Triple operator-(const Triple& a, const Triple& b) {
    return {{a.x[0] - b.x[0], a.x[1] - b.x[1], a.x[2] - b.x[2]}};
  }
  friend RESILIN_INLINE Triple operator*(const Real& s, const Triple& a) {
    return {{s * a.x[0], s * a.x[1], s * a.x[2]}};
  }
};

/// Scalar product.
template <class Real>
RESILIN_INLINE Real dot(const Triple<Real>& a, const Triple<Real>& b) {
  return a.x[0] * b.x[0] + a.x[1] * b.x[1] + a.x[2] * b.x[2];
}

/// Vector product.
template <class Real>
RESILIN_INLINE Triple<Real> cross(const Triple<Real>& a, const Triple<Real>& b) {
  return {{a.x[1] * b.x[2] - a.x[2] * b.x[1], a.x[2] * b.x[0] - a.x[0] * b.x[2],
           a.x[0] * b.x[1] - a.x[1] * b.x[0]}};
}

/// Component by component: a where the mask is set, else b.
template <class Mask, class Real>
RESILIN_INLINE Triple<Real> select(Mask mask, const Triple<Real>& a, const Triple<Real>& b) {
  return {{select(mask, a.x[0], b.x[0]), select(mask, a.x[1], b.x[1]), select(mask, a.x[2], b.x[2])}};
}

}  // namespace resilin
