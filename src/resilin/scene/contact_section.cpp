#include "resilin/scene/sections.hpp"

namespace resilin {
namespace {

/// What the contract says of contact; checked, so that a wrong number is told before the refusal.
struct ContactDescription {
  bool is_enabled = true;
  double friction = 0;
};

Keys<ContactDescription> contact_keys() {
  using C = ContactDescription;
  return {
      key<C>({"enabled", "true or false", "", "true", "Bodies push each other and themselves away."},
             [](const SceneNode& node, C& c) { c.is_enabled = read_flag(node); }),
      number_key("friction", &C::friction, "", not_negative, "Coefficient of friction."),
  };
}

}  // namespace

void refuse_contact(const SceneNode& node) {
  ContactDescription contact;
  read_section(node, contact_keys(), contact);
  if (contact.is_enabled) {
    refuse_later(node, "bodies pass through each other here: leave [contact] out or set enabled = false");
  }
}

void refuse_collider(const SceneNode& node) {
  if (node.value->is_array() && node.value->array().empty()) return;
  const SceneNode first = node.value->is_array() ? node.element(0) : node;
  if (first.has("friction")) read_number(first.child("friction"), not_negative);
  refuse_later(first, "hold vertices with [[fix]] where the body would touch");
}

}  // namespace resilin
