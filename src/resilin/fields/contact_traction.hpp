#pragma once

#include <string>
#include <vector>

#include "resilin/world/state.hpp"
#include "resilin/world/world.hpp"

namespace resilin {

/// Nominal traction of bodies and colliders on each node, over the area at rest that they press on: dim
/// numbers per node [Pa]. A node on a sharp edge has its share of the faces that look against the force
/// alone.
VectorX contact_traction(const World& world, const State& state);

/// True pressure: the force against the outward normal of these faces over their deformed area, one number
/// per node [Pa]; positive where the surface is pressed upon. Its integral over the deformed surface is the
/// force.
VectorX contact_pressure(const World& world, const State& state);

/// Surface on which a collider presses, or a body on the one that is named before it.
struct ContactPatch {
  std::string collider;       ///< its name; empty: of two bodies
  Index body = -1;            ///< number of the body that is pressed on ...
  Index other = -1;           ///< ... by this one; of a collider neither is told
  double area = 0;            ///< deformed, of nodes with more than a hundredth of the largest pressure [m^2]
  double reference_area = 0;  ///< area of the same nodes at rest [m^2]
  double width = 0;           ///< in 2D, deformed length of the same nodes in the plane [m]
  double force = 0;           ///< sum of the normal forces [N]
  double largest_pressure = 0;       ///< true pressure [Pa]
  Vector3 center = Vector3::Zero();  ///< centre of pressure, in the scene's coordinates [m]
  Vector3 extent = Vector3::Zero();  ///< reach of these nodes along the axes, deformed [m]
  double mean_pressure() const { return area > 0 ? force / area : 0; }
};

/// One for each collider that touches something, then one for each two bodies that touch, in the order of the
/// scene.
std::vector<ContactPatch> contact_patches(const World& world, const State& state);

}  // namespace resilin
