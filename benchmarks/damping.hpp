#pragma once

#include "scenes.hpp"

namespace resilin::bench {

/// The falling cube with and without material damping (5 % of the critical one in its slowest swing), the two
/// step by step in turns: processor time, iterations and the ratio of the times.
/// @param n        cells along an edge
/// @param element  a name of element/catalog.hpp for tetrahedra
std::vector<Measurement> measure_damping(int n, const std::string& element);

}  // namespace resilin::bench
