#pragma once

#include "resilin/contact/collider_shape.hpp"

namespace resilin {

/// Everything below a plane; in 2D below a line. d = n.(x - o).
class HalfSpace final : public ColliderShape {
 public:
  /// @param normal  out of the solid; of any length but zero
  HalfSpace(const Vector3& point, const Vector3& normal) : point_(point), normal_(normal.normalized()) {}

  std::string_view kind() const override { return "half_space"; }
  bool is_flat() const override { return true; }
  Vector3 reference_point() const override { return point_; }
  ColliderMesh facets(int dim, const Vector3& middle, double reach) const override {
    return plate_mesh(middle - distance(middle) * normal_, normal_, 2 * reach, dim);
  }
  double distance(const Vector3& x) const override { return normal_.dot(x - point_); }
  double distance_change(const Vector3& from, const Vector3& to) const override {
    return normal_.dot(to - from);
  }
  Vector3 normal(const Vector3&) const override { return normal_; }
  Eigen::Matrix3d curvature(const Vector3&) const override { return Eigen::Matrix3d::Zero(); }
  double time_of_approach(const Vector3& x, const Vector3& p, double distance) const override {
    const double speed = -normal_.dot(p);
    return speed > 0 ? (this->distance(x) - distance) / speed : std::numeric_limits<double>::infinity();
  }

 private:
  Vector3 point_, normal_;
};

}  // namespace resilin
