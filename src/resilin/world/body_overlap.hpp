#pragma once

#include <string>
#include <vector>

#include "resilin/world/world.hpp"

namespace resilin {

/// Two bodies that share space, and cells of them that do.
struct BodyOverlap {
  std::size_t body, other;           ///< in the world
  Index cell = -1, other_cell = -1;  ///< cell and other cell of these; -1: their surfaces alone decide
  Vector3 place;                     ///< about where [m]
};

/// Bodies that share space when they stand at x; such as only touch do not. Of a pair the first cells are
/// named. Sides of cells are taken as flat between their corners; where `contact` has the bodies' surfaces,
/// its finer parts decide. For bodies with a contact skin only full containment is detected.
std::vector<BodyOverlap> overlapping_bodies(const World& world, const VectorX& x,
                                            const SurfaceContact* contact);

/// "bodies "a" and "b" share space, cell 3 of "a" and cell 7 of "b" near (0, 0, 1)".
std::string describe(const World& world, const BodyOverlap& overlap);

}  // namespace resilin
