#pragma once

#include "resilin/core/types.hpp"
#include "resilin/picture/image.hpp"

namespace resilin {

/// How bright a facet is: lit from above, over the left shoulder; the same from behind.
/// @param normal  as the camera sees it, of length 1
double light(const Vector3& normal);

/// A body's own colour under a light.
Color shaded(Color color, double brightness);

/// The colour of a field under a light: shape is seen, and the colour is still found on the bar.
Color shaded_field(Color color, double brightness);

}  // namespace resilin
