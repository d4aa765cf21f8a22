#pragma once

#include <string>
#include <vector>

#include "scenes.hpp"

namespace resilin::bench {

/// A scene and the hand that plays with it: for a second it takes the vertex farthest from the supports in a
/// circle, then it lets go.
struct LiveCase {
  std::string name;
  Description description;
  double tolerance = 1e-4;  ///< at which a step counts as solved: force residual as a share of the load
  int newton_limit = 0;     ///< Newton iterations of a step; 0: until it is solved
};

/// Cost of a second of pulling and a second after it, and how far each step was from the solved one.
struct LiveTiming {
  Index cells = 0, vertices = 0, drawn = 0;
  double median_ms = 0, p95_ms = 0, largest_ms = 0;  ///< wall time of a step with its surface
  double drawing_ms = 0;          ///< time of drawing: positions and normals of the surface, median
  double cpu_ms = 0;              ///< mean processor time of a step, all threads
  double newton = 0, linear = 0;  ///< iterations of a step, mean
  double residual = 0;            ///< median force residual as a share of the load
  double worst_residual = 0;
  double error = 0;  ///< median distance to the solved step, as a share of the displacement
  double worst_error = 0;
  int inverted = 0;  ///< steps that ended with cells turned inside out
};

LiveTiming measure_live(const LiveCase& live_case);

/// Cubes, Spot and, where $RESILIN_SHARED has it, the armadillo.
std::vector<LiveCase> live_cases();

std::vector<Measurement> measure_view();

}  // namespace resilin::bench
