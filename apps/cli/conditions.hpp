#pragma once

#include <cstddef>

#include "resilin/world/world.hpp"

namespace resilin::cli {

/// A line for each boundary condition and load: what it acts on, and what a load amounts to.
/// @param most  of each; how many more there are is told
void print_conditions(const World& world, std::size_t most = 1000);

}  // namespace resilin::cli
