#pragma once

#include <string>
#include <string_view>

#include "resilin/core/types.hpp"

namespace resilin {

/// Everything that a step reads and changes. Equal states give equal steps, bit by bit.
struct State {
  int step = 0;
  double time = 0;     ///< [s]
  double load = 0;     ///< load factor of a static run; 1 in motion
  VectorX positions;   ///< [m]
  VectorX velocities;  ///< [m/s]; zero in statics

  // Static load control: what the next increment is and where its guess is extrapolated from.
  double load_increment = 1;
  double previous_load = 0;
  VectorX previous_positions;
};

/// Exact binary image of a state, for checkpoints.
std::string serialize(const State& state);

/// The state of an image. Throws InputError naming `place` when it is damaged or of another version.
State deserialize_state(std::string_view image, const std::string& place);

}  // namespace resilin
