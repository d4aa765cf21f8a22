#pragma once

#include <vector>

#include "resilin/world/description.hpp"
#include "resilin/world/world.hpp"

namespace resilin {

/// Whether anything that a scene says follows time: functions, windows, velocities.
bool follows_time(const Description& description);

/// Whether a step of the scene releases a support or switches a contact pair (support_phase.hpp).
bool has_phases(const Description& description);

/// Times at which loads and prescribed motions begin, end or have a kink, rising [s].
std::vector<double> event_times(const Description& description);

/// Makes a support that would turn far at once turn as fast as steps may, and be there before the end; warns
/// of it. Called before `find_events`, for its end is an event.
void ease_turn(const Rotation& turn, World& world, Support& support);

/// Fills in the world's events. Warns of those that a static run does not reach; throws InputError where it
/// cannot follow time.
void find_events(const Description& description, World& world);

}  // namespace resilin
