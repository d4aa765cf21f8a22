#include "resilin/mesh/closest_point.hpp"

#include <algorithm>
#include <limits>

namespace resilin {

std::array<double, 3> closest_on_triangle(const Vector3& p, const Vector3& a, const Vector3& b,
                                          const Vector3& c) {
  // Above the inside of the triangle it is the foot of the perpendicular: solve the 2 x 2 normal equations.
  const Vector3 u = b - a, v = c - a, w = p - a;
  const double uu = u.squaredNorm(), uv = u.dot(v), vv = v.squaredNorm(), wu = w.dot(u), wv = w.dot(v);
  // A triangle thinner than this is met by its sides to 1e-5 of its length.
  constexpr double thin = 1e-10;
  const double determinant = uu * vv - uv * uv;  // (2 area)^2
  if (determinant > thin * uu * vv) {
    const double s = (vv * wu - uv * wv) / determinant, t = (uu * wv - uv * wu) / determinant;
    if (s >= 0 && t >= 0 && s + t <= 1) return {1 - s - t, s, t};
  }
  const std::array<const Vector3*, 3> corners = {&a, &b, &c};
  std::array<double, 3> best{};
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t j = (i + 1) % 3;
    const auto [at_i, at_j] = closest_on_segment(p, *corners[i], *corners[j]);
    const double distance = (at_i * *corners[i] + at_j * *corners[j] - p).squaredNorm();
    if (distance < least) {
      least = distance;
      best = {};
      best[i] = at_i;
      best[j] = at_j;
    }
  }
  return best;
}

}  // namespace resilin
