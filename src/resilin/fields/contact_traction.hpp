#pragma once

#include "resilin/world/state.hpp"
#include "resilin/world/world.hpp"

namespace resilin {

/// Traction of bodies and colliders on each node over the rest area that they press on: dim numbers per node
/// [Pa]. A node on a sharp edge has its share of the faces that look against the force alone.
VectorX contact_traction(const World& world, const State& state);

/// Its part against the outward normal of these faces, one number per node [Pa]; positive where the surface
/// is pressed upon.
VectorX contact_pressure(const World& world, const State& state);

}  // namespace resilin
