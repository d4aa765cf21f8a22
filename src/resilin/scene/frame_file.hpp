#pragma once

#include <iosfwd>
#include <string>
#include <vector>

#include "resilin/simulation/state.hpp"
#include "resilin/simulation/world.hpp"

namespace resilin {

/// Names that `output.fields` may hold.
std::vector<std::string> frame_field_names();

/// Writes a state as VTU: the points at their deformed places, the fields of `world.output` on points
/// (displacement, velocity) and cells (the others), and the number of the body on each cell.
void write_frame(std::ostream& stream, const World& world, const State& state);

}  // namespace resilin
