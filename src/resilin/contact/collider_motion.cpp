#include "resilin/contact/collider_motion.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "resilin/contact/cross_matrix.hpp"

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
  return sum + spin(time).cross(x - place(time)(turn->center));
}

Vector3 ColliderMotion::spin(double time) const {
  if (time > until + time_slack(time) || !turn) return Vector3::Zero();
  return turn->degrees_per_second * std::numbers::pi / 180 * turn->axis.normalized();
}

// Its axis moves along with all but its place as it was made.
ColliderMotion::Slopes ColliderMotion::slopes_by(std::string_view name, double time) const {
  const Eigen::Matrix3d I = Eigen::Matrix3d::Identity(), zero = Eigen::Matrix3d::Zero();
  if (name == "place") return {place(time).turn.value_or(I), zero};
  const bool is_velocity = name == "velocity";
  const double way = is_velocity ? std::min(time, until) : time_function.value(time);
  const double rate = !is_velocity ? time_function.rate(time) : time > until + time_slack(time) ? 0 : 1;
  const Eigen::Matrix3d shift = way * I;
  return {shift, rate * I - cross_matrix(spin(time)) * shift};
}

double ColliderMotion::degrees_between(double from, double to) const {
  return std::abs((std::min(to, until) - std::min(from, until)) * turning_speed());
}

}  // namespace resilin
