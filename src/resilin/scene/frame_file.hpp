#pragma once

#include <iosfwd>
#include <span>

#include "resilin/fields/evaluator.hpp"

namespace resilin {

/// Writes a state as VTU: the points at their deformed places, the fields on points and cells, and the number
/// of the body on each cell.
void write_frame(std::ostream& stream, const World& world, const State& state,
                 std::span<const FieldValues> fields);

}  // namespace resilin
