#pragma once

#include <string>
#include <vector>

#include "resilin/world/state.hpp"
#include "resilin/world/world.hpp"

namespace resilin {

/// Whether contact presses each body mostly between its nodes, inside facets whose corners are beyond the
/// activation distance, or at a single node: a ball on one cell. The mesh cannot represent the indentation,
/// and no estimate of the discretisation error sees it. False for bodies that other forces strain ten times
/// as hard.
/// @return one value per body
std::vector<bool> have_narrow_contact(const World& world, const State& state);

/// One line for each of these bodies.
std::vector<std::string> narrow_contact_texts(const World& world, const State& state);

}  // namespace resilin
