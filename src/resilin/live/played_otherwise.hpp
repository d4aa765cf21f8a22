#pragma once

#include <string>
#include <vector>

#include "resilin/world/description.hpp"

namespace resilin {

/// How a live scene goes on from a frame of a run otherwise than the run itself did, one line each; none
/// where its steps are those of the run as far as they are solved in their time.
std::vector<std::string> played_otherwise(const Description& scene);

}  // namespace resilin
