#pragma once

#include <array>
#include <span>

#include "resilin/collision/rank_one_sum.hpp"

namespace resilin {

/// Fades a pair of edges out as they become parallel, where the direction of their distance jumps:
///
///   m(c) = (2 - c / eps) c / eps for c < eps, 1 beyond;  c = |a x b|^2 of the deformed edges a and b
///
/// C1 at eps. eps = 1e-3 |A|^2 |B|^2 of the rest edges, so that m depends on the angle alone at rest.
/// Source: Li et al. 2020, "Incremental Potential Contact", eq. 24.
struct EdgeMollifier {
  double threshold;  ///< eps [m^4]

  static EdgeMollifier of_rest_edges(const Vector3& A, const Vector3& B) {
    return of_rest_lengths(A.norm() * B.norm());
  }
  /// @param product  of both lengths at rest [m^2]
  static EdgeMollifier of_rest_lengths(double product) { return {1e-3 * product * product}; }

  bool fades(double c) const { return c < threshold; }
  double value(double c) const { return fades(c) ? (2 - c / threshold) * (c / threshold) : 1; }
  double slope(double c) const { return fades(c) ? 2 * (1 - c / threshold) / threshold : 0; }  ///< m'
  /// m(c + change) - m(c), with its digits when the change is small.
  double difference(double c, double change) const {
    if (!fades(c) || !fades(c + change)) return value(c + change) - value(c);
    return (2 - (2 * c + change) / threshold) * (change / threshold);
  }
  double curvature(double c) const { return fades(c) ? -2 / (threshold * threshold) : 0; }  ///< m''
};

/// c(to) - c(from) for c = |a x b|^2 of edges x0 x1 and x2 x3, with its digits when the two are close.
double edge_cross_change(std::span<const Vector3, 4> from, std::span<const Vector3, 4> to);

/// c = |a x b|^2 [m^4] of the edges x0 x1 and x2 x3, a frame for it and its derivatives.
class EdgeCross {
 public:
  explicit EdgeCross(std::span<const Vector3, 4> vertices);

  double squared() const { return area_ * area_; }

  PairVector<3> gradient() const;  ///< grad c

  /// Adds `factor` Hess c. In the plane of the edges c = D^2 with D = a1 b2 - a2 b1, a bilinear form whose
  /// eigenvectors are known; across it c is a sum of two squares.
  void add_hessian(double factor, RankOneSum<3>& sum) const;

 private:
  PairVector<3> spread(const Vector3& of_a, const Vector3& of_b) const;

  Vector3 first_, second_, normal_;  ///< unit vectors: along a, in the plane of a and b, across it
  double length_;                    ///< a = length first
  double along_, across_;            ///< b = along first + across second, across >= 0
  double area_;                      ///< D = |a x b| [m^2]
};

}  // namespace resilin
