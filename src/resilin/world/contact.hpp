#pragma once

#include <memory>
#include <string>

#include "resilin/contact/surface_contact.hpp"
#include "resilin/world/world.hpp"

namespace resilin {

/// The contact term between bodies in the first phase, or null without contact; sets that of all phases.
/// Throws InputError for a description that cannot be, for bodies that touch, cross or share space at the
/// start, and for an activation distance that reaches across a body.
std::shared_ptr<const SurfaceContact> make_contact(const ContactDescription& description, World& world);

/// Replaces the contact between bodies, in friction too, by that of another phase.
void use_contact(World& world, const std::shared_ptr<const SurfaceContact>& contact);

/// Bodies that meet now, did not by the contact of before, and overlap or touch, in words; empty: none.
std::string overlap_of_begun_contact(const World& world, const SurfaceContact& before,
                                     const VectorX& positions);

/// Gives a world other contact between its bodies, and with it other friction.
/// Throws InputError as `make_contact` does; the world is then as before.
void change_contact(World& world, const ContactDescription& description);

}  // namespace resilin
