#pragma once

#include "resilin/world/world.hpp"

namespace resilin {

/// What a scene says of contact.
struct ContactWishes {
  std::vector<ColliderDescription> colliders;
  ContactDescription contact;
};

/// Shorter activation distances for a scene whose bodies start so near to others that contact would push them
/// away (pushed_bodies), so that bodies start where they are drawn: in motion a little less than the gap, in
/// statics, where contact has to hold them, a little more. Distances that the scene sets stay, and none gets
/// shorter than a hundredth of the default. Adds a note to the world for each.
/// @param wishes  of which the world's terms of contact are made; changed in place
/// @returns whether any distance is shorter now: those terms are to be made anew
bool shorten_activation_distances(ContactWishes& wishes, World& world);

}  // namespace resilin
