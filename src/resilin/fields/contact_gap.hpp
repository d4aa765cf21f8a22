#pragma once

#include "resilin/world/state.hpp"
#include "resilin/world/world.hpp"

namespace resilin {

/// How far each node is from what it feels of other bodies, of its own and of colliders, one number per node
/// [m]: the smallest distance of the facets, edges and points that it is a corner of. Where nothing is near
/// it is the largest activation distance there is; 0 in a scene without contact.
VectorX contact_gap(const World& world, const State& state);

}  // namespace resilin
