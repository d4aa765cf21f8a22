#pragma once

#include <cstdint>
#include <vector>

#include "resilin/world/world.hpp"

namespace resilin {

/// For each body the process that gets each of its cells: about equal numbers with few nodes between them, by
/// METIS (Karypis & Kumar 1998). Every process gets cells of every body; the same parts on every run.
/// @throws InputError  when a body has fewer cells than there are processes
std::vector<std::vector<std::int32_t>> partition_cells(const World& world, int num_ranks);

}  // namespace resilin
