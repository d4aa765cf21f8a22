#include "resilin/live/drive.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <utility>

#include "resilin/core/error.hpp"
#include "resilin/core/text.hpp"
#include "resilin/world/joint_maker.hpp"

namespace resilin {
namespace {

constexpr double fastest_turn = 2 * std::numbers::pi;  ///< fastest turn of an angle on its way [rad/s]
constexpr double allowed_over_shown = 10;              ///< largest value, relative to the slider
constexpr double usual_gravity = 9.81;                 ///< for motors without force in the scene [m/s^2]
constexpr double least_of_cable = 0.3;                 ///< slider of a shortening, relative to the length

/// The factor 1 at all times and load factors.
TimeFunction always() { return {TimeFunction::Table{.times = {0}, .values = {1}}}; }

/// The largest magnitude of a time function.
double peak_of(const TimeFunction& function) {
  if (const auto* points = std::get_if<TimeFunction::Table>(&function.form)) {
    double peak = 0;
    for (const double value : points->values) peak = std::max(peak, std::abs(value));
    return peak;
  }
  if (const auto* sine = std::get_if<TimeFunction::Sine>(&function.form))
    return std::abs(sine->offset) + std::abs(sine->amplitude);
  return 1;
}

/// The next number 1, 2 or 5 times a power of ten.
double round_up(double x) {
  const double power = std::pow(10, std::floor(std::log10(x)));
  for (const double digit : {1.0, 2.0, 5.0})
    if (x <= digit * power * (1 + 1e-9)) return digit * power;
  return 10 * power;
}

Drive::Kind kind_of(JointKind joint, const MotorDescription& motor) {
  using enum Drive::Kind;
  const bool is_hinge = joint == JointKind::hinge;
  if (motor.effort) return is_hinge ? torque : force;
  if (motor.velocity) return is_hinge ? angular_velocity : velocity;
  return is_hinge ? angle : displacement;
}

/// Ends of the slider of a motor whose values reach `peak` in the scene.
void choose_range(const JointDescription& joint, double peak, const World& world, Drive& drive) {
  using enum Drive::Kind;
  const double turn = 2 * std::numbers::pi;
  if (drive.kind == angle) {
    drive.greatest = peak > 0 && 2 * peak < std::numbers::pi ? round_up(2 * peak) : turn;
  } else if (peak > 0) {
    drive.greatest = round_up(2 * peak);
  } else if (drive.kind == angular_velocity) {
    drive.greatest = 2 * turn;
  } else if (drive.is_rate() || drive.kind == displacement) {
    drive.greatest = round_up(0.5 * world.largest_extent());
  } else {
    double weight = 0;
    for (const Body& body : world.bodies) weight += body.mass * usual_gravity;
    const double arm = drive.kind == torque ? world.largest_extent() : 1;
    drive.greatest = weight > 0 ? round_up(2 * weight * arm) : 1;
  }
  drive.least = -drive.greatest;
  if ((drive.kind == angle || drive.kind == displacement) && joint.limits.size() == 2) {
    drive.least = joint.limits[0];
    drive.greatest = joint.limits[1];
  }
}

/// "drive.NAME", which no other drive has.
std::string free_key(const std::string& name, std::set<std::string>& taken) {
  std::string key = "drive." + name;
  for (int number = 2; !taken.insert(key).second; ++number)
    key = "drive." + name + " " + std::to_string(number);
  return key;
}

}  // namespace

std::string_view Drive::quantity() const {
  switch (kind) {
    case Kind::angle:
      return "angle";
    case Kind::displacement:
      return "displacement";
    case Kind::angular_velocity:
      return "angular velocity";
    case Kind::velocity:
      return "velocity";
    case Kind::torque:
      return "torque";
    case Kind::force:
      return "force";
    case Kind::tension:
      return "tension";
    case Kind::shortening:
      return "shortening";
  }
  return "";
}

std::string_view Drive::unit() const {
  switch (kind) {
    case Kind::angle:
      return "rad";
    case Kind::displacement:
    case Kind::shortening:
      return "m";
    case Kind::angular_velocity:
      return "rad/s";
    case Kind::velocity:
      return "m/s";
    case Kind::torque:
      return "N m";
    case Kind::force:
    case Kind::tension:
      return "N";
  }
  return "";
}

double Drive::largest_allowed() const {
  return allowed_over_shown * std::max(std::abs(least), std::abs(greatest));
}

void check_value(const Drive& drive, double value) {
  const double largest = drive.largest_allowed();
  const double least = drive.kind == Drive::Kind::tension ? 0 : -largest;
  if (value >= least && value <= largest) return;
  const std::string unit = " " + std::string(drive.unit());
  throw InputError(drive.key,
                   "a number from " + format_short(least) + unit + " to " + format_short(largest) + unit,
                   format_short(value));
}

Drives::Drives(const Description& description, const World& world) {
  std::set<std::string> taken;
  for (std::size_t i = 0; i < description.joints.size(); ++i) {
    const JointDescription& joint = description.joints[i];
    if (!joint.motor) continue;
    const MotorDescription& motor = *joint.motor;
    Drive drive{.key = free_key(joint.name, taken),
                .name = joint.name,
                .kind = kind_of(joint.kind, motor),
                .number = i};
    Source source{.amplitude = motor.effort.value_or(motor.velocity.value_or(motor.position)),
                  .function = motor.time_function,
                  .motor = motor,
                  .in_world = i};
    choose_range(joint, std::abs(source.amplitude) * peak_of(source.function), world, drive);
    all_.push_back(std::move(drive));
    sources_.push_back(std::move(source));
  }
  for (std::size_t i = 0; i < description.cables.size(); ++i) {
    const CableDescription& cable = description.cables[i];
    const std::size_t in_world = description.springs.size() + i;
    Drive drive{.key = free_key(cable.name, taken), .name = cable.name, .number = i};
    drive.kind = cable.tension ? Drive::Kind::tension : Drive::Kind::shortening;
    Source source{.amplitude = cable.tension.value_or(cable.shortening),
                  .function = cable.time_function,
                  .cable = cable,
                  .in_world = in_world};
    const double length = world.cables[in_world]->length(world.rest_positions);
    const double peak = std::abs(source.amplitude) * peak_of(source.function);
    source.cable.rest_length = cable.rest_length.value_or(length);
    source.cable.time_function = always();
    const double usual = cable.tension ? 1 : least_of_cable * (length > 0 ? length : world.largest_extent());
    drive.greatest = round_up(peak > 0 ? 2 * peak : usual);
    drive.least = source.amplitude < 0 ? -drive.greatest : 0;
    all_.push_back(std::move(drive));
    sources_.push_back(std::move(source));
  }
}

double Drives::value_in_scene(const Drive& drive, const Source& source, const Conditions& c) const {
  if (drive.is_rate()) return source.amplitude * source.function.value(c.time);
  return source.amplitude * source.function.factor(c.time, c.load);
}

void Drives::set_goal(std::size_t number, double value, const Conditions& now) {
  if (number >= all_.size())
    throw InputError("drive", "the number of one of " + std::to_string(all_.size()) + " motors and cables",
                     std::to_string(number));
  Drive& drive = all_[number];
  Source& source = sources_[number];
  check_value(drive, value);
  if (!drive.is_driven) {
    drive.value = value_in_scene(drive, source, now);
    const double of_velocity = source.motor ? source.motor->velocity.value_or(0) : 0;
    source.reached = drive.is_rate() ? of_velocity * source.function.integral(now.time) : 0;
  }
  drive.is_driven = true;
  drive.goal = value;
}

void Drives::leave(World& world) {
  for (std::size_t i = 0; i < all_.size(); ++i) {
    Drive& drive = all_[i];
    Source& source = sources_[i];
    drive.is_driven = false;
    drive.goal = drive.value;
    if (source.of_scene.empty()) continue;
    const auto put_back = [&](TermOrigin origin, std::size_t at) {
      if (const auto term = world.find_term(origin)) world.terms[*term] = source.of_scene[at];
    };
    if (source.motor) {
      put_back({TermOrigin::Kind::joint, drive.number, world.joints[source.in_world].terms.size() - 1}, 0);
    } else {
      put_back({TermOrigin::Kind::cable, drive.number}, 0);
      if (source.of_scene.size() > 1) put_back({TermOrigin::Kind::cable, drive.number, 1}, 1);
    }
    source.of_scene.clear();
  }
}

void Drives::reset(const Conditions& start, World& world) {
  const std::vector<Drive> before = all_;
  leave(world);
  for (std::size_t i = 0; i < all_.size(); ++i) {
    all_[i].value = value_in_scene(all_[i], sources_[i], start);
    if (before[i].is_driven) set_goal(i, before[i].goal, start);
  }
}

void Drives::follow_scene(const Conditions& now) {
  for (std::size_t i = 0; i < all_.size(); ++i)
    if (!all_[i].is_driven) all_[i].goal = all_[i].value = value_in_scene(all_[i], sources_[i], now);
}

double Drives::step_of(const Drive& drive, double time_step) const {
  double rate = (drive.greatest - drive.least) / seconds_of_slider;
  if (drive.kind == Drive::Kind::angle) rate = std::min(rate, fastest_turn);
  return std::clamp(drive.goal - drive.value, -rate * time_step, rate * time_step);
}

bool Drives::advance(double time_step, World& world) {
  bool is_changed = false;
  for (std::size_t i = 0; i < all_.size(); ++i) {
    Drive& drive = all_[i];
    Source& source = sources_[i];
    if (!drive.is_driven) continue;
    const double step = step_of(drive, time_step);
    const double way = drive.is_rate() ? time_step * (drive.value + step) : 0;
    if (step == 0 && way == 0 && !source.of_scene.empty()) continue;
    drive.value = drive.value + step;
    source.reached += way;
    put_into(drive, source, world);
    is_changed = true;
  }
  return is_changed;
}

void Drives::put_into(const Drive& drive, Source& source, World& world) const {
  const bool is_first = source.of_scene.empty();
  const auto replace = [&](TermOrigin origin, std::shared_ptr<const Energy> term) {
    std::shared_ptr<const Energy>& place = world.terms[world.find_term(origin).value()];
    if (is_first) source.of_scene.push_back(place);
    place = std::move(term);
  };
  if (source.motor) {
    const Joint& joint = world.joints[source.in_world];
    MotorDescription motor = *source.motor;
    motor.time_function = always();
    motor.velocity.reset();
    if (drive.is_rate()) {
      motor.position = source.reached;
    } else if (motor.effort) {
      motor.effort = drive.value;
    } else {
      motor.position = drive.value;
    }
    replace({TermOrigin::Kind::joint, drive.number, joint.terms.size() - 1}, make_motor(motor, joint, world));
    return;
  }
  CableDescription description = source.cable;
  if (description.tension)
    description.tension = drive.value;
  else
    description.shortening = drive.value;
  const Cable& old = *world.cables[source.in_world];
  const std::shared_ptr<const Cable> cable =
      make_cable(description, world.dimension, old.path().points(), old.length(world.rest_positions));
  replace({TermOrigin::Kind::cable, drive.number}, cable);
  if (const auto& friction = world.cable_frictions[source.in_world])
    replace({TermOrigin::Kind::cable, drive.number, 1},
            std::make_shared<CableFriction>(cable, friction->coefficient(), friction->speed()));
}

bool Drives::any_moves() const {
  return std::ranges::any_of(all_, [](const Drive& drive) {
    return drive.is_driven && (drive.value != drive.goal || (drive.is_rate() && drive.value != 0));
  });
}

double Drives::largest_turn(double time_step) const {
  double largest = 0;
  for (const Drive& drive : all_) {
    if (!drive.is_driven) continue;
    if (drive.kind == Drive::Kind::angle) largest = std::max(largest, std::abs(step_of(drive, time_step)));
    if (drive.kind == Drive::Kind::angular_velocity)
      largest = std::max(largest, std::abs(drive.value + step_of(drive, time_step)) * time_step);
  }
  return largest * 180 / std::numbers::pi;
}

bool Drives::any_is_endless() const {
  for (std::size_t i = 0; i < all_.size(); ++i) {
    if (all_[i].is_driven || sources_[i].amplitude == 0) continue;
    if (all_[i].is_rate() || std::holds_alternative<TimeFunction::Sine>(sources_[i].function.form))
      return true;
  }
  return false;
}

}  // namespace resilin
