#pragma once

#include <string>

#include "resilin/simulation/simulation.hpp"

namespace resilin {

/// Progress of a long step: "step 3, from load factor 0.25 by 0.125 at most, Newton iteration 48, residual
/// 0.031 (tolerance 1e-08)".
///
/// @param simulation  within the step
/// @param so_far      of the search that is going on; its residual is shown relative to the load
/// @param iterations  of the whole step so far, those of attempts that failed included
std::string describe_progress(const Simulation& simulation, const NewtonReport& so_far, int iterations);

}  // namespace resilin
