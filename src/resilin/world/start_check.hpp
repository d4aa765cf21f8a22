#pragma once

#include "resilin/world/world.hpp"

namespace resilin {

/// Throws InputError for a start at which the energy of a body is not finite, as when a cell is inverted
/// under a law that needs J > 0: names the cell. The world's bodies are complete.
void check_start(const Description& description, const World& world);

/// Bodies that start with cells of no volume, where the Cauchy stress has no value; one line each.
std::vector<std::string> starts_without_volume(const World& world);

/// A body that starts so far inside the activation distance of others that contact pushes it away with more
/// than what acts on it, along an axis in which nothing holds it.
struct PushedBody {
  std::size_t body;
  std::vector<std::size_t> terms;  ///< numbers of the contact terms that push it
  std::size_t strongest;           ///< number of the one that pushes most
  double push;                     ///< [N]
  double load;                     ///< the most that loads and gravity add up to [N]
};
/// Terms of contact and loads are complete, and so are the fixed unknowns.
/// @param times  of its load that contact has to push with
std::vector<PushedBody> pushed_bodies(const World& world, double times);

/// One line for each pushed body.
std::vector<std::string> starts_pushed_off(const World& world);

/// Whether nothing ever acts: no force on a free vertex, no velocity at the start, no support or collider
/// that moves, at any time or load. The world is complete. Asks for forces at the start, and at some more
/// times where they are zero.
bool is_idle(const World& world);

/// Boundary conditions that move vertices into a collider, with which fixed vertices have no contact; one
/// line each. The world is complete.
std::vector<std::string> supports_in_colliders(const World& world);

}  // namespace resilin
