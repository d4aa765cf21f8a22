#pragma once

#include "resilin/sensitivity/world_change.hpp"

/// How the prescribed motion follows from the numbers of its supports and from the rest shape.
namespace resilin {

/// The change of places, velocities and accelerations at the fixed unknowns under these conditions, written
/// into `motion`; the other unknowns are left alone.
void place_prescribed_changes(const World& world, const WorldChange& change, const Conditions& conditions,
                              Motion& motion);

/// The transpose: adds what slopes by these say of the numbers of the world.
void add_prescribed_slopes(const World& world, const Motion& by_motion, const Conditions& conditions,
                           WorldChange& slopes);

}  // namespace resilin
