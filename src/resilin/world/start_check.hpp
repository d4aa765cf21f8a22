#pragma once

#include "resilin/world/world.hpp"

namespace resilin {

/// Throws InputError for a start at which the energy of a body is not finite, as when a cell is inverted
/// under a law that needs J > 0: names the cell. The world's bodies are complete.
void check_start(const Description& description, const World& world);

/// Bodies that start with cells of no volume, where the Cauchy stress has no value; one line each.
std::vector<std::string> starts_without_volume(const World& world);

/// Bodies that start so far inside the activation distance of a collider or of another body that contact
/// pushes them away with many times what acts on them, along an axis in which nothing holds them; one line
/// each. The world is complete.
std::vector<std::string> starts_pushed_off(const World& world);

/// Whether nothing ever acts: no force on a free vertex, no velocity at the start, no support or collider
/// that moves, at any time or load. The world is complete. Asks for forces at the start, and at some more
/// times where they are zero.
bool is_idle(const World& world);

/// Boundary conditions that move vertices into a collider, with which fixed vertices have no contact; one
/// line each. The world is complete.
std::vector<std::string> supports_in_colliders(const World& world);

}  // namespace resilin
