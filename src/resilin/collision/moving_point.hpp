#pragma once

#include <span>
#include <vector>

namespace resilin {

/// A vertex that goes from x to x + p in a straight line: one line of the cache, which lanes read at once. In
/// 2D the third component is zero.
struct alignas(64) MovingPoint {
  double x[4];  ///< [m]; the last is zero
  double p[4];  ///< [m]
};

/// @param positions      one number per coordinate, vertex by vertex [m]
/// @param displacements  as many, or none for vertices at rest [m]
std::vector<MovingPoint> moving_points(int dim, std::span<const double> positions,
                                       std::span<const double> displacements = {});

}  // namespace resilin
