#pragma once

#include <vector>

#include "scenes.hpp"

namespace resilin::bench {

/// Three seconds of examples/heap.toml as the page plays it: each step, with positions and normals of the
/// surface, in the time of a frame. To be started in the root of the repository.
std::vector<Measurement> measure_heap();

}  // namespace resilin::bench
