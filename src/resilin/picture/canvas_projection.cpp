#include "resilin/picture/canvas_projection.hpp"

#include <algorithm>
#include <limits>

namespace resilin {

CanvasProjection fit(const Camera& camera, const std::vector<Vector3>& points,
                     const std::array<double, 4>& box) {
  Vector3 low = Vector3::Constant(std::numeric_limits<double>::infinity()), high = -low;
  for (const Vector3& point : points) {
    low = low.cwiseMin(camera.turned(point));
    high = high.cwiseMax(camera.turned(point));
  }
  const auto [left, top, right, bottom] = box;
  const Vector3 size = high - low;
  CanvasProjection projection{.camera = camera};
  const double widest = std::max({size.x() / (right - left), size.y() / (bottom - top), 1e-300});
  projection.zoom = 1 / widest;
  const Vector3 middle = 0.5 * projection.zoom * (low + high);
  projection.shift = Vector3(0.5 * (left + right), -0.5 * (top + bottom), 0) - middle;
  return projection;
}

}  // namespace resilin
