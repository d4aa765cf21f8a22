#pragma once

#include <algorithm>
#include <array>

#include "resilin/core/types.hpp"

namespace resilin {

/// The point of a segment that is nearest to p, as shares of its ends.
inline std::array<double, 2> closest_on_segment(const Vector3& p, const Vector3& a, const Vector3& b) {
  const Vector3 ab = b - a;
  const double length = ab.squaredNorm();
  const double t = length > 0 ? std::clamp((p - a).dot(ab) / length, 0.0, 1.0) : 0.0;
  return {1 - t, t};
}

/// The point of a triangle that is nearest to p, as shares of its corners; flat triangles are taken by their
/// sides.
std::array<double, 3> closest_on_triangle(const Vector3& p, const Vector3& a, const Vector3& b,
                                          const Vector3& c);

}  // namespace resilin
