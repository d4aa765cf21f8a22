#pragma once

#include <iosfwd>
#include <span>
#include <string>
#include <vector>

#include "resilin/simulation/state.hpp"
#include "resilin/simulation/world.hpp"

namespace resilin {

/// A quantity on the vertices, or on the cells of all bodies one after another.
struct FrameField {
  const char* name;
  int components;  ///< for each vertex or cell: 1, 3 or, row by row, 9
  bool is_on_points;
  std::vector<double> (*values)(const World& world, const State& state);
};
std::span<const FrameField> frame_fields();

/// Names that `output.fields` may hold.
std::vector<std::string> frame_field_names();

/// Writes a state as VTU: the points at their deformed places, the fields of `world.output` on points
/// (displacement, velocity) and cells (the others), and the number of the body on each cell.
void write_frame(std::ostream& stream, const World& world, const State& state);

}  // namespace resilin
