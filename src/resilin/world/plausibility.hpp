#pragma once

#include <string>
#include <vector>

#include "resilin/world/description.hpp"

namespace resilin {

/// Orders of magnitude that suggest wrong units, one sentence each: a body that its weight would crush, a
/// mesh in millimetres, a time step that spans many periods of the body.
std::vector<std::string> implausible_numbers(const Description& description);

}  // namespace resilin
