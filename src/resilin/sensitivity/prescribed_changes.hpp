#pragma once

#include "resilin/sensitivity/world_change.hpp"

/// Derivatives of the prescribed motion by parameters of boundary conditions and by the reference positions.
namespace resilin {

/// The change of places, velocities and accelerations at the fixed unknowns under these conditions, written
/// into `motion`; the other unknowns are left alone.
void place_prescribed_changes(const World& world, const WorldChange& change, const Conditions& conditions,
                              Motion& motion);

/// Moves the unknowns that follow from others by ties, constraints and joints with these.
void follow(const World& world, Motion& change);
/// The transpose: slopes by what follows become slopes by what it follows.
void follow_transposed(const World& world, VectorX& slopes);
void follow_transposed(const World& world, Motion& slopes);

/// The transpose of `place_prescribed_changes`: adds what slopes by these say of the numbers of the world.
/// Where unknowns follow others, these have their slopes already (`follow_transposed`).
void add_prescribed_slopes(const World& world, const Motion& by_motion, const Conditions& conditions,
                           WorldChange& slopes);

}  // namespace resilin
