#pragma once

#include "scenes.hpp"

namespace resilin::bench {

/// Six laws fitted to three tests of a rubber, 53 points as Treloar's have: milliseconds of the wall clock
/// for each law and for all with intervals, stability and curves.
std::vector<Measurement> measure_fits();

}  // namespace resilin::bench
