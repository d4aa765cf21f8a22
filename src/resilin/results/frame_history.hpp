#pragma once

#include <vector>

#include "resilin/world/world.hpp"

namespace resilin {

/// Name of the array of a frame that holds the internal variables of materials, by cell.
constexpr const char* history_name = "internal_variables";

/// Number of internal variables of a cell, the most of all domains; 0 for a world without.
int history_width(const World& world);

/// Internal variables of a state (State::history) by cell, body after body: `history_width` numbers for each
/// cell, zeros where it has fewer.
std::vector<double> history_by_cell(const World& world, const VectorX& history);

/// The inverse.
VectorX history_of_cells(const World& world, const std::vector<double>& by_cell);

}  // namespace resilin
