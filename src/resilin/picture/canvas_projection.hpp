#pragma once

#include <array>
#include <vector>

#include "resilin/picture/camera.hpp"

namespace resilin {

/// Places on the canvas.
struct CanvasProjection {
  Camera camera;
  double zoom = 1;
  Vector3 shift = Vector3::Zero();

  Vector3 operator()(const Vector3& point) const {
    const Vector3 turned = zoom * camera.turned(point) + shift;
    return {turned.x(), -turned.y(), turned.z()};
  }
  /// The point that is seen at a place of the canvas.
  Vector3 point_at(const Vector3& place) const {
    const Vector3 turned = (Vector3(place.x(), -place.y(), place.z()) - shift) / zoom;
    return turned.x() * camera.right + turned.y() * camera.up + turned.z() * camera.toward;
  }
};

/// Largest zoom with which all points lie in a box of pixels from (left, top) to (right, bottom).
CanvasProjection fit(const Camera& camera, const std::vector<Vector3>& points,
                     const std::array<double, 4>& box);

}  // namespace resilin
