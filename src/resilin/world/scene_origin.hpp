#pragma once

#include "resilin/world/description.hpp"

namespace resilin {

/// Where a world's coordinates best begin [m], in those of the scene: at zero, unless the bodies together
/// stand farther from there than a hundred times their extent, where positions would lose digits; then where
/// the first body was translated to if that is among them, so that its translation costs no rounding at all,
/// else in their middle. Components beyond the dimension are zero.
Vector3 find_scene_origin(const Description& description);

/// The same scene in coordinates that begin at `origin`.
Description with_origin(const Description& description, const Vector3& origin);

}  // namespace resilin
