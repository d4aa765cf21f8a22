#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "resilin/world/world.hpp"

namespace resilin {

constexpr double seconds_of_slider = 0.5;  ///< a drive takes as long for all of its slider

/// The motor of a joint or a cable, which a slider drives in a live scene.
struct Drive {
  enum class Kind { angle, displacement, angular_velocity, velocity, torque, force, tension, shortening };
  std::string key;   ///< key of messages and saved values: "drive.NAME", the name of the joint or the cable
  std::string name;  ///< name of the joint or the cable
  Kind kind = Kind::angle;
  std::size_t number = 0;          ///< number of the joint or the cable in the description
  double least = 0, greatest = 0;  ///< ends of the slider [rad, m, rad/s, m/s, N m or N]
  double value = 0;                ///< present value; follows the scene's time function until it is driven
  double goal = 0;                 ///< value to which a slider has set it
  bool is_driven = false;

  bool is_of_cable() const { return kind == Kind::tension || kind == Kind::shortening; }
  bool is_rate() const { return kind == Kind::angular_velocity || kind == Kind::velocity; }
  std::string_view quantity() const;  ///< "angle", in words
  std::string_view unit() const;
  double largest_allowed() const;  ///< largest magnitude that may be set
};

/// Throws InputError for a value that cannot be set.
void check_value(const Drive& drive, double value);

/// The drives of a scene, and the energies that stand in the world for those that are driven.
class Drives {
 public:
  Drives() = default;
  /// @param description  which the world was made from
  Drives(const Description& description, const World& world);

  const std::vector<Drive>& all() const { return all_; }
  /// Sets a goal. The drive goes there from its present value, its whole slider in half a second.
  /// Throws InputError for a value that cannot be.
  void set_goal(std::size_t number, double value, const Conditions& now);
  /// All drives as the scene has them again.
  void leave(World& world);
  /// Driven ones begin again where the scene has them under these conditions.
  void reset(const Conditions& start, World& world);
  /// Values of those that are not driven, under these conditions.
  void follow_scene(const Conditions& now);
  /// Moves driven values on by a time step, and puts their energies into the world.
  /// @return whether an energy has changed
  bool advance(double time_step, World& world);

  /// Whether a motor or cable that a slider drives still moves: to its goal, or at its velocity.
  bool any_moves() const;
  /// The largest angle that a driven motor turns in a time step [degrees].
  double largest_turn(double time_step) const;
  /// Whether a time function of the scene moves a motor or cable without end.
  bool any_is_endless() const;

 private:
  /// Numbers behind a drive.
  struct Source {
    double amplitude = 0;  ///< at a factor 1
    TimeFunction function{};
    std::optional<MotorDescription> motor{};  ///< none: a cable
    CableDescription cable{};
    std::size_t in_world = 0;  ///< number in World::joints or World::cables
    double reached = 0;  ///< reached by a motor with a velocity: the angle or displacement that it leads to
    std::vector<std::shared_ptr<const Energy>> of_scene{};  ///< the energies that driven ones stand for
  };

  double value_in_scene(const Drive& drive, const Source& source, const Conditions& c) const;
  double step_of(const Drive& drive, double time_step) const;
  void put_into(const Drive& drive, Source& source, World& world) const;

  std::vector<Drive> all_;
  std::vector<Source> sources_;
};

}  // namespace resilin
