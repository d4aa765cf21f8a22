#pragma once

#include "resilin/world/description.hpp"

namespace resilin {

/// Throws InputError for a choice that is none and a number that cannot be, wherever the description came
/// from. What depends on meshes, laws and bodies is for those that read these.
void check_description(const Description& description);

/// Throws InputError unless it is finite and > 0.
void require_positive(double value, const std::string& place);

/// Throws InputError for the number of an axis that a space of `dim` dimensions does not have.
void require_axis(int axis, int dim, const std::string& place);

}  // namespace resilin
