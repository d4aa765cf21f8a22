#pragma once

#include "resilin/world/world.hpp"

namespace resilin {

/// Settings of a scene for contact.
struct ContactWishes {
  std::vector<ColliderDescription> colliders;
  ContactDescription contact;
};

/// Shorter activation distances for a scene whose bodies start so near to others that contact would push them
/// away (pushed_bodies): about those at which contact carries their loads where they are drawn, and pushes
/// not at all where there is no load; rounded to powers of 1.1 [m], so that derivatives hold. Distances that
/// the scene sets stay, and none gets shorter than a hundredth of the default. Adds a note to the world for
/// each.
/// @param wishes  of which the world's terms of contact are made; changed in place
/// @returns whether any distance is shorter now: those terms are to be made anew
bool shorten_activation_distances(ContactWishes& wishes, World& world);

}  // namespace resilin
