#pragma once

#include <memory>

#include "resilin/contact/surface_contact.hpp"
#include "resilin/world/world.hpp"

namespace resilin {

/// The contact term between bodies, or null without contact. Throws InputError for a description that cannot
/// be, for bodies that touch, cross or share space at the start, and for an activation distance that reaches
/// across a body.
std::shared_ptr<const SurfaceContact> make_contact(const ContactDescription& description, World& world);

/// Gives a world other contact between its bodies, and with it other friction.
/// Throws InputError as `make_contact` does; the world is then as before.
void change_contact(World& world, const ContactDescription& description);

}  // namespace resilin
