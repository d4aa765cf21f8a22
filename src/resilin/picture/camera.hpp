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

/// Names of views, such as "front".
std::vector<std::string> view_names();  ///< without "auto", which is `telling_direction`

/// Direction of "x", "y" or "z"; any other word is refused. @throws InputError
Vector3 axis_of(const std::string& letter);

/// @param view  one of the names, or "x,y,z", a direction from the body to the eye
/// @param up    of any length but zero; 2D looks along z with y up
/// @throws InputError
Camera make_camera(int dimension, const std::string& view, const Vector3& up);

/// From a direction, from the body to the eye, in space.
Camera make_camera(const Vector3& toward, const Vector3& up);

/// From the body to the eye in the page's first look: from half to the left or the right, a little from
/// above.
/// @param turn       about `up` from there [rad]
/// @param elevation  above the horizon [rad]
Vector3 page_direction(const Vector3& up, double turn, double elevation);

/// Among directions around a body the one that shows most of it and of how it has moved; the page's unless
/// another shows clearly more.
/// @param triangles  corners of the surface, three for each triangle
/// @param moved      displacements of these corners; may be empty
Vector3 telling_direction(const std::vector<Vector3>& triangles, const std::vector<Vector3>& moved,
                          const Vector3& up);

}  // namespace resilin
