#include "resilin/collision/moving_point.hpp"

#include "resilin/core/parallel.hpp"

namespace resilin {

std::vector<MovingPoint> moving_points(int dim, std::span<const double> positions,
                                       std::span<const double> displacements) {
  const auto d = static_cast<std::size_t>(dim);
  std::vector<MovingPoint> points(positions.size() / d);
  parallel_for(points.size(), 1 << 14, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v)
      for (std::size_t i = 0; i < d; ++i) {
        points[v].x[i] = positions[v * d + i];
        if (!displacements.empty()) points[v].p[i] = displacements[v * d + i];
      }
  });
  return points;
}

}  // namespace resilin
