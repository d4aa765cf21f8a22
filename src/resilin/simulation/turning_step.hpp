#pragma once

#include "resilin/world/state.hpp"
#include "resilin/world/world.hpp"

/// Steps in time that turn supports by more than one step may: they go in equal parts.
namespace resilin {

/// The angle that a support turns by in a step [degrees]; the first one begins where nothing has turned.
double turn_of_step(const World& world, const State& state, double time_step);

/// Whether none of the equal parts of a step turns a support too far.
/// @param length  of a part [s]
bool turns_evenly(const World& world, const State& state, double length, int num_parts);

/// The world with supports that turn evenly from the start of a step to its end, whatever their functions do
/// in between.
World with_even_turns(const World& world, const State& state, double time_step);

}  // namespace resilin
