#pragma once

#include <array>
#include <limits>
#include <optional>
#include <string_view>

#include "resilin/core/types.hpp"
#include "resilin/energy/time_function.hpp"

namespace resilin {

/// Placement of a rigid body: x = turn X + shift.
struct RigidPlace {
  std::optional<Eigen::Matrix3d> turn;  ///< none: as it was made
  Vector3 shift = Vector3::Zero();      ///< [m]

  Vector3 operator()(const Vector3& X) const { return turned(X) + shift; }
  Vector3 inverse(const Vector3& x) const { return turned_back(x - shift); }
  Vector3 turned(const Vector3& direction) const { return turn ? Vector3(*turn * direction) : direction; }
  Vector3 turned_back(const Vector3& direction) const {
    return turn ? Vector3(turn->transpose() * direction) : direction;
  }
};

/// A turn about an axis, which moves along with what is turned.
struct ColliderTurn {
  Vector3 axis = Vector3::UnitZ();   ///< its length does not matter
  Vector3 center = Vector3::Zero();  ///< a point of the axis at the start [m]
  double degrees = 0;                ///< at the start
  double degrees_per_second = 0;
};

/// How a collider moves as time passes: at a velocity and turning until a time, and besides by a displacement
/// times a function of time.
struct ColliderMotion {
  Vector3 velocity = Vector3::Zero();                      ///< [m/s]
  double until = std::numeric_limits<double>::infinity();  ///< end of velocity and turn [s]
  Vector3 displacement = Vector3::Zero();                  ///< [m]
  TimeFunction time_function{};
  std::optional<ColliderTurn> turn{};
  /// It is round about the axis that it turns about: as time passes the turn changes velocities alone, not
  /// places, so that facets which stand for something round do not plough through what they carry along.
  bool turns_in_place = false;

  bool is_at_rest() const { return keeps_place() && !(turn && turn->degrees_per_second != 0); }
  bool keeps_place() const { return is_straight() && velocity.isZero(0); }
  /// Whether its points move on lines, evenly up to `until`.
  bool is_straight() const { return displacement.isZero(0) && turning_speed() == 0; }
  RigidPlace place(double time) const;
  /// Velocity of the material point at x: where rates jump, the one from before [m/s].
  Vector3 velocity_at(const Vector3& x, double time) const;
  /// Angular velocity about its axis [1/s].
  Vector3 spin(double time) const;

  /// To first order in its numbers of a name.
  struct Slopes {
    Eigen::Matrix3d shift;  ///< shift of its place
    Eigen::Matrix3d rate;   ///< rate of the velocity of what stays where it is [1/s]
  };
  /// "place": of what moves, as it was made; "velocity"; "displacement".
  static constexpr std::array<std::string_view, 3> parameter_names = {"place", "velocity", "displacement"};
  Slopes slopes_by(std::string_view name, double time) const;
  double degrees_between(double from, double to) const;

 private:
  /// Speed at which its places turn [degrees/s].
  double turning_speed() const { return turn && !turns_in_place ? turn->degrees_per_second : 0; }
};

}  // namespace resilin
