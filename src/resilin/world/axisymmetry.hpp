#pragma once

#include "resilin/mesh/depth.hpp"
#include "resilin/world/world.hpp"

namespace resilin {

/// Whether the scene is one of axisymmetric solids: elements of all bodies have axisymmetric names
/// (element/axisymmetric.hpp).
bool is_axisymmetric(const Description& description);
bool is_axisymmetric(const World& world);

/// Depth of the plane that the world is in.
Depth depth_of(const World& world);

/// Refuses what axisymmetric scenes cannot have: one line each.
void check_axisymmetry(const Description& description);

/// Throws InputError where a vertex of a body has a negative radius.
void check_radii(const BodyDescription& description, const VectorX& rest_positions, Index first_node);

/// Fixes u_r of nodes on the axis that no boundary condition prescribes, and tells how many they are.
void fix_axis(World& world);

}  // namespace resilin
