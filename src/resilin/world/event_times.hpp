#pragma once

#include <vector>

#include "resilin/world/description.hpp"

namespace resilin {

/// Where loads and prescribed motions begin, end or have a kink, rising [s].
std::vector<double> event_times(const Description& description);

}  // namespace resilin
