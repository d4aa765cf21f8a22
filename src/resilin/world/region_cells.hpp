#pragma once

#include <vector>

#include "resilin/world/description.hpp"

namespace resilin {

/// Numbers of the cells of a body, rising: [0] those that belong to no region, [k] those of region k - 1. A
/// cell belongs to the first region that means it.
/// @param is_part      of a body, whose regions may be empty
/// @throws InputError  for a region that gets no cell, an unknown group, a name that is empty or another's
std::vector<std::vector<Index>> cells_of_domains(const BodyDescription& body, int dim, bool is_part);

}  // namespace resilin
