#pragma once

#include <string>
#include <vector>

#include "resilin/core/types.hpp"

namespace resilin {

/// Where a picture is taken from: three directions of length 1, at right angles. Parallel projection.
struct Camera {
  Vector3 right, up;
  Vector3 toward;  ///< from the body to the eye

  /// Along the three directions.
  Vector3 turned(const Vector3& v) const { return {right.dot(v), up.dot(v), toward.dot(v)}; }
};

std::vector<std::string> view_names();

/// @param view      one of the names, or "x,y,z", a direction from the body to the eye
/// @param vertical  "x", "y" or "z": the axis that points up, 2D looks along z with y up
/// @throws InputError
Camera make_camera(int dimension, const std::string& view, const std::string& vertical);

}  // namespace resilin
