#pragma once

namespace resilin {

/// The length y of a slip without its corner at rest: f0(0) = 0 and f0' = f1(y) = 2 y/eps - (y/eps)^2 for
/// y < eps, 1 beyond. Source: Li et al. 2020, "Incremental Potential Contact", 5.4.
struct MollifiedSlip {
  double eps;  ///< [m]

  /// f0(y) [m].
  double length(double y) const { return y < eps ? y * y / eps * (1 - y / (3 * eps)) : y - eps / 3; }

  /// f0(end) - f0(y), with its digits where `change` = end - y is small.
  double length_change(double y, double end, double change) const {
    if (end < y) return -length_change(end, y, -change);
    const auto below = [this](double from, double to, double way) {
      return way / eps * (from + to - (from * from + from * to + to * to) / (3 * eps));
    };
    if (y >= eps) return change;
    return end >= eps ? end - eps + below(y, eps, eps - y) : below(y, end, change);
  }

  /// c = f1(y) / y [1/m].
  double slope_over_slip(double y) const { return y < eps ? (2 - y / eps) / eps : 1 / y; }

  /// -c' / c [1/m].
  double fall_of_slope(double y) const { return y < eps ? 1 / (2 * eps - y) : 1 / y; }
};

}  // namespace resilin
