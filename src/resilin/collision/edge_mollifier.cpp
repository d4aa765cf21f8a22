#include "resilin/collision/edge_mollifier.hpp"

#include <Eigen/Geometry>
#include <cmath>

namespace resilin {

double edge_cross_change(std::span<const Vector3, 4> from, std::span<const Vector3, 4> to) {
  const Vector3 a0 = from[1] - from[0], b0 = from[3] - from[2], a1 = to[1] - to[0], b1 = to[3] - to[2];
  const Vector3 da = (to[1] - from[1]) - (to[0] - from[0]), db = (to[3] - from[3]) - (to[2] - from[2]);
  const Vector3 change = da.cross(b1) + a0.cross(db);  // change of the cross product
  return change.dot(a0.cross(b0) + a1.cross(b1));
}

EdgeCross::EdgeCross(std::span<const Vector3, 4> vertices) {
  const Vector3 a = vertices[1] - vertices[0], b = vertices[3] - vertices[2], N = a.cross(b);
  length_ = a.norm();
  first_ = length_ > 0 ? Vector3(a / length_) : Vector3(b.normalized());
  area_ = N.norm();
  if (area_ > 0) {
    normal_ = N / area_;
    normal_ = (normal_ - normal_.dot(first_) * first_).normalized();
  } else {
    Eigen::Index axis = 0;
    first_.cwiseAbs().minCoeff(&axis);
    normal_ = first_.cross(Vector3::Unit(axis)).normalized();
  }
  second_ = normal_.cross(first_);
  along_ = b.dot(first_);
  across_ = length_ > 0 ? area_ / length_ : 0;
}

/// How the vertices see a vector for each edge: the end of an edge with it, the start against it.
PairVector<3> EdgeCross::spread(const Vector3& of_a, const Vector3& of_b) const {
  PairVector<3> u;
  u << -of_a, of_a, -of_b, of_b;
  return u;
}

// dD = a1 db2 + b2 da1 - a2 db1 - b1 da2 with a2 = 0.
PairVector<3> EdgeCross::gradient() const {
  return 2 * area_ * spread(across_ * first_ - along_ * second_, length_ * second_);
}

void EdgeCross::add_hessian(double factor, RankOneSum<3>& sum) const {
  sum.add(2 * factor, spread(across_ * first_ - along_ * second_, length_ * second_));
  // 2 D Hess D: couples a1 with b2 by 1 and a2 with b1 by -1.
  for (const double sign : {1.0, -1.0}) {
    sum.add(sign * factor * area_, spread(first_, sign * second_));
    sum.add(sign * factor * area_, spread(second_, -sign * first_));
  }
  // A motion (alpha, beta) of a and b across the plane: c = |beta a - alpha b|^2.
  sum.add(2 * factor, spread(-along_ * normal_, length_ * normal_));
  sum.add(2 * factor, spread(-across_ * normal_, Vector3::Zero()));
}

}  // namespace resilin
