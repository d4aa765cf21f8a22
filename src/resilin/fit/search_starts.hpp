#pragma once

#include <span>
#include <vector>

#include "resilin/fit/scene_model.hpp"

namespace resilin {

/// Starts of searches for these unknowns: first where these say, then at places that fill the space between
/// their bounds evenly, in logarithms of what is positive; without bounds within a factor of 10 of the start,
/// or, of what may be negative, once its size to both sides.
std::vector<VectorX> search_starts(std::span<const SceneUnknown> unknowns, int count);

}  // namespace resilin
