#pragma once

#include <cmath>
#include <limits>

namespace resilin {

/// The clamped log barrier in its physical form: work per area and stiffness of a layer that cannot be
/// crossed.
///
///   b(d) = -dhat (t - 1)^2 ln t,  t = (d - r) / dhat,  for 0 < d - r < dhat; 0 beyond; +infinity for d <= r
///
/// C2 at dhat + r. The radius r is that of a ball, d then the distance from its centre; otherwise zero. b'
/// has no unit, so that a stiffness [Pa] times b' is a pressure whatever dhat is. Source: Li et al. 2023,
/// "Convergent Incremental Potential Contact", arXiv 2307.15908.
struct ClampedLogBarrier {
  double activation_distance;  ///< dhat [m]
  double radius = 0;           ///< r [m]

  /// The barrier is zero from this distance on [m].
  double reach() const { return radius + activation_distance; }

  /// b [m].
  double value(double distance) const {
    const double d = distance - radius;
    if (d >= activation_distance) return 0;
    if (!(d > 0)) return std::numeric_limits<double>::infinity();
    const double t = d / activation_distance;
    return -activation_distance * (t - 1) * (t - 1) * std::log(t);
  }

  /// b' <= 0; for d > r.
  double slope(double distance) const {
    const double d = distance - radius;
    if (d >= activation_distance) return 0;
    const double t = d / activation_distance, s = t - 1;
    return -2 * s * std::log(t) - s * s / t;
  }

  /// b'' >= 0 [1/m]; for d > r.
  double curvature(double distance) const {
    const double d = distance - radius;
    if (d >= activation_distance) return 0;
    const double t = d / activation_distance, s = t - 1;
    return (-2 * std::log(t) - 4 * s / t + s * s / (t * t)) / activation_distance;
  }

  /// b(d + change) - b(d) [m] for d > r, with its digits when the change is small:
  /// s1^2 ln t1 - s0^2 ln t0 = (s1 - s0) (s1 + s0) ln t1 + s0^2 ln(t1 / t0), s = t - 1.
  double difference(double distance, double change) const {
    const double d = distance - radius, end = d + change;
    if (!(end > 0)) return std::numeric_limits<double>::infinity();
    if (d >= activation_distance || end >= activation_distance)
      return value(distance + change) - value(distance);
    const double s0 = d / activation_distance - 1, s1 = end / activation_distance - 1;
    const double step = change / activation_distance;
    return -activation_distance *
           (step * (s0 + s1) * std::log(end / activation_distance) + s0 * s0 * std::log1p(change / d));
  }
};

}  // namespace resilin
