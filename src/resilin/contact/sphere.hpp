#pragma once

#include <cmath>

#include "resilin/contact/collider_shape.hpp"

namespace resilin {

/// A ball; in 2D a disc. Bodies stay outside. d = |x - c| - r.
class Sphere final : public ColliderShape {
 public:
  Sphere(const Vector3& center, double radius) : center_(center), radius_(radius) {}

  std::string_view kind() const override { return "sphere"; }
  Vector3 reference_point() const override { return center_; }
  double radius() const override { return radius_; }
  ColliderMesh facets(int dim, const Vector3&, double) const override {
    return ball_mesh(center_, radius_, dim);
  }
  double distance(const Vector3& x) const override { return (x - center_).norm() - radius_; }
  /// |b| - |a| = (b - a).(b + a) / (|b| + |a|)
  double distance_change(const Vector3& from, const Vector3& to) const override {
    const Vector3 a = from - center_, b = to - center_;
    const double lengths = a.norm() + b.norm();
    return lengths > 0 ? (to - from).dot(a + b) / lengths : 0;
  }
  Vector3 normal(const Vector3& x) const override { return (x - center_).normalized(); }
  Eigen::Matrix3d curvature(const Vector3& x) const override {
    const Vector3 n = normal(x);
    return (Eigen::Matrix3d::Identity() - n * n.transpose()) / (x - center_).norm();
  }
  /// The first root of |x - c + t p| = r + distance.
  double time_of_approach(const Vector3& x, const Vector3& p, double distance) const override {
    constexpr double never = std::numeric_limits<double>::infinity();
    const Vector3 y = x - center_;
    const double reach = radius_ + distance;
    const double half_slope = y.dot(p);
    if (half_slope >= 0) return never;
    const double gap = (y.norm() - reach) * (y.norm() + reach);
    const double discriminant = half_slope * half_slope - p.squaredNorm() * gap;
    return discriminant < 0 ? never : gap / (std::sqrt(discriminant) - half_slope);
  }

 private:
  Vector3 center_;
  double radius_;
};

}  // namespace resilin
