#include "resilin/world/event_times.hpp"

#include <algorithm>

#include "resilin/core/error.hpp"
#include "resilin/core/text.hpp"
#include "resilin/world/colliders.hpp"
#include "resilin/world/viscoelastic_material.hpp"

namespace resilin {

bool has_phases(const Description& description) {
  const auto is_switched = [](const auto& entry) { return !entry.switches.empty(); };
  return std::ranges::any_of(description.fixes, is_switched) ||
         std::ranges::any_of(description.contact.pairs, is_switched);
}

bool follows_time(const Description& description) {
  const auto moves = [](const ColliderDescription& collider) {
    return !motion_of(collider, /*end_time=*/1).is_at_rest();
  };
  const auto varies = [](const auto& entry) {
    return !entry.velocity.isZero(0) || !entry.time_function.is_constant();
  };
  const auto follows = [](const ConstraintDescription& constraint) {
    return !constraint.time_function.is_constant();
  };
  const auto has_function = [](const auto& entry) { return !entry.time_function.is_constant(); };
  const auto has_motor = [&](const JointDescription& joint) {
    return joint.motor && (joint.motor->velocity || has_function(*joint.motor));
  };
  const auto rubs_at_times = [](const ColliderDescription& collider) {
    return !collider.friction_factor.is_constant();
  };
  const auto is_windowed = [](const LoadDescription& load) { return load.from > 0 || load.until; };
  return std::ranges::any_of(description.fixes, varies) || has_phases(description) ||
         !description.gravity_function.is_constant() || !description.contact.friction_factor.is_constant() ||
         std::ranges::any_of(description.colliders, rubs_at_times) ||
         std::ranges::any_of(description.constraints, follows) ||
         std::ranges::any_of(description.joints, has_motor) ||
         std::ranges::any_of(description.cables, has_function) ||
         std::ranges::any_of(description.loads, varies) ||
         std::ranges::any_of(description.loads, is_windowed) ||
         std::ranges::any_of(description.colliders, moves) ||
         std::ranges::any_of(description.bodies, has_history);
}

std::vector<double> event_times(const Description& description) {
  std::vector<double> times;
  const auto add = [&times](const auto& entry) {
    const std::vector<double> kinks = entry.time_function.kinks();
    times.insert(times.end(), kinks.begin(), kinks.end());
    if (entry.until) times.push_back(*entry.until);
  };
  const auto add_switches = [&times](const auto& entry) {
    times.insert(times.end(), entry.switches.begin(), entry.switches.end());
  };
  for (const FixDescription& fix : description.fixes) {
    add(fix);
    add_switches(fix);
  }
  std::ranges::for_each(description.contact.pairs, add_switches);
  if (has_phases(description))
    for (const StepDescription& step : description.steps) times.push_back(step.end);
  const auto add_kinks = [&times](const TimeFunction& function) {
    const std::vector<double> kinks = function.kinks();
    times.insert(times.end(), kinks.begin(), kinks.end());
  };
  add_kinks(description.gravity_function);
  add_kinks(description.contact.friction_factor);
  for (const ColliderDescription& collider : description.colliders) add_kinks(collider.friction_factor);
  const auto add_function = [&times](const auto& entry) {
    const std::vector<double> kinks = entry.time_function.kinks();
    times.insert(times.end(), kinks.begin(), kinks.end());
  };
  for (const ConstraintDescription& constraint : description.constraints) add_function(constraint);
  for (const CableDescription& cable : description.cables) add_function(cable);
  for (const JointDescription& joint : description.joints)
    if (joint.motor) add_function(*joint.motor);
  for (const ColliderDescription& collider : description.colliders) add(collider);
  for (const LoadDescription& load : description.loads) {
    add(load);
    times.push_back(load.from);
  }
  std::ranges::sort(times);
  times.erase(std::unique(times.begin(), times.end()), times.end());
  return times;
}

void ease_turn(const Rotation& turn, World& world, Support& support) {
  const int num_steps = num_steps_of_turn(turn.degrees);
  const double end = std::min(num_steps * world.time_step, world.end_time);
  support.time_function.form = TimeFunction::Ramp{.from = 0, .until = end};
  world.event_times.push_back(end);
  world.warnings.push_back(support.place + ".rotate: a rotation of " + format_short(turn.degrees) +
                           " degrees at once takes " + format_short(end) +
                           " s, because no step rotates by more than " + format_short(largest_turn_of_step) +
                           "; set its speed with a time_function");
}

void find_events(const Description& description, World& world) {
  if (world.follows_path && world.path_time > 0) {
    throw InputError(world.place + ": simulation.load_control",
                     "\"load\" if loads, boundary conditions or colliders depend on time", "\"arc_length\"",
                     "arc length needs loads in proportion to the load factor");
  }
  std::vector<double>& times = world.event_times;  // those of supports that are eased are there
  const std::vector<double> described = event_times(description);
  times.insert(times.end(), described.begin(), described.end());
  std::ranges::sort(times);
  times.erase(std::unique(times.begin(), times.end()), times.end());
  if (world.path_time > 0 && !world.event_times.empty() && world.event_times.back() > world.path_time) {
    world.warnings.push_back(world.place + ": simulation.end_time: the load factor is 1 at " +
                             format_short(world.path_time) + " s, but loads or motions change until " +
                             format_short(world.event_times.back()) + " s");
  }
}

}  // namespace resilin
