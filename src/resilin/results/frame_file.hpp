#pragma once

#include <iosfwd>
#include <span>

#include "resilin/fields/evaluator.hpp"
#include "resilin/io/vtu.hpp"

namespace resilin {

/// A state as a frame of a file: the points at their deformed places, the fields on points and cells, and the
/// number of the body on each cell. Bodies of one kind of cell stand together, else in their order.
VtuContent frame_content(const World& world, const State& state, std::span<const FieldValues> fields);

void write_frame(std::ostream& stream, const VtuContent& content);

}  // namespace resilin
