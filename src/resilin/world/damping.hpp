#pragma once

#include "resilin/energy/damping.hpp"
#include "resilin/world/world.hpp"

namespace resilin {

/// The damping that a description asks for, of a world whose bodies and masses are complete; may be empty.
Terms damping_terms(const Description& description, const World& world);

}  // namespace resilin
