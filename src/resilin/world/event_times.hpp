#pragma once

#include <vector>

#include "resilin/world/description.hpp"

namespace resilin {

/// Whether anything that a scene says follows time: functions, windows, velocities.
bool follows_time(const Description& description);

/// Where loads and prescribed motions begin, end or have a kink, rising [s].
std::vector<double> event_times(const Description& description);

}  // namespace resilin
