#include "resilin/contact/collider_motion.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace resilin {

RigidPlace ColliderMotion::place(double time) const {
  const double moved = std::min(time, until);
  RigidPlace place{.turn = std::nullopt, .shift = moved * velocity};
  if (!displacement.isZero(0)) place.shift += time_function.value(time) * displacement;
  if (!turn) return place;
  const double degrees = turn->degrees + moved * turning_speed();
  if (degrees == 0) return place;
  place.turn =
      Eigen::AngleAxisd(degrees * std::numbers::pi / 180, turn->axis.normalized()).toRotationMatrix();
  place.shift += turn->center - *place.turn * turn->center;
  return place;
}

Vector3 ColliderMotion::velocity_at(const Vector3& x, double time) const {
  Vector3 sum = Vector3::Zero();
  if (!displacement.isZero(0)) sum += time_function.rate(time) * displacement;
  if (time > until + time_slack(time)) return sum;
  sum += velocity;
  if (!turn || turn->degrees_per_second == 0) return sum;
  const Vector3 spin = turn->degrees_per_second * std::numbers::pi / 180 * turn->axis.normalized();
  return sum + spin.cross(x - place(time)(turn->center));
}

double ColliderMotion::degrees_between(double from, double to) const {
  return std::abs((std::min(to, until) - std::min(from, until)) * turning_speed());
}

}  // namespace resilin
