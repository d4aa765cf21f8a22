#include "resilin/contact/catalog.hpp"
#include "resilin/scene/tables.hpp"

namespace resilin {
namespace {

Keys<ContactPairDescription> contact_pair_keys() {
  using P = ContactPairDescription;
  return {
      key<P>(
          {"bodies", "list of 2 texts", "", "required", "The names of two bodies, or of one twice: itself."},
          [](const SceneNode& node, P& pair) {
            expect_list(node, "names of bodies", 2);
            for (std::size_t i = 0; i < 2; ++i) pair.bodies[i] = read_text(node.element(i));
          }),
      key<P>({"enabled", "true or false", "", default_text(P{}.is_enabled),
              "Whether they keep each other apart."},
             [](const SceneNode& node, P& pair) { pair.is_enabled = read_flag(node); }),
  };
}

void read_contact_pair(const SceneNode& node, ContactPairDescription& pair) {
  pair.place = node.place();
  read_table(node, contact_pair_keys(), pair);
}

}  // namespace

Keys<ContactDescription> contact_keys() {
  using C = ContactDescription;
  return {
      key<C>({"enabled", "true or false", "", default_text(C{}.is_enabled),
              "Bodies keep each other apart; else they pass through each other."},
             [](const SceneNode& node, C& c) { c.is_enabled = read_flag(node); }),
      key<C>({"self", "true or false", "", default_text(C{}.with_themselves),
              "Each body keeps its own parts apart, too."},
             [](const SceneNode& node, C& c) { c.with_themselves = read_flag(node); }),
      key<C>({"activation_distance", "number > 0", "m",
              "0.005 of the smallest body's extent; with `self` at most half the thinnest gap",
              "From here on bodies feel each other; they rest at about half of it."},
             [](const SceneNode& node, C& c) { c.activation_distance = read_number(node, positive); }),
      key<C>({"stiffness", "number > 0", "Pa", "0.1 of the softer body's Young's modulus",
              "Pressure at about half the activation distance; a stiffer one lets bodies come less near."},
             [](const SceneNode& node, C& c) { c.stiffness = read_number(node, positive); }),
      key<C>({"friction", "0", "", "0", "Bodies slide freely; another coefficient is refused."},
             [](const SceneNode& node, C&) {
               if (read_number(node, not_negative) > 0)
                 refuse_later(node, "bodies slide along each other freely: leave it out or set it to 0");
             }),
      key<C>({"pair", "[[contact.pair]]", "", "none", "Pairs of bodies that are not to follow the above."},
             [](const SceneNode& node, C& c) {
               if (!node.value->is_array()) node.fail("a list of tables, each headed [[contact.pair]]");
               for (std::size_t i = 0; i < node.value->array().size(); ++i) {
                 c.pairs.emplace_back();
                 read_contact_pair(node.element(i), c.pairs.back());
               }
             }),
  };
}

TableDoc contact_pair_doc() {
  return document("[[contact.pair]]",
                  "Two bodies, or one and itself, that meet in another way than all others.",
                  contact_pair_keys());
}

void read_contact(const SceneNode& node, ContactDescription& contact) {
  contact.place = node.place();
  read_table(node, contact_keys(), contact);
}

Keys<ColliderDescription> collider_keys() {
  using C = ColliderDescription;
  std::vector<std::string> kinds;
  for (const ShapeKind& kind : shape_kinds()) kinds.emplace_back(kind.name);
  return {
      text_key("name", &C::name, "collider[0] ...", "The force on the bodies is reported under it."),
      {.doc = {"kind", one_of(kinds), "", "required",
               "A half_space fills one side of a plane (2D: of a line)."},
       .read = [kinds](const SceneNode& node, C& c) { c.kind = read_choice(node, kinds); },
       .is_required = true},
      key<C>({"point", "vector", "m", "required for a half_space", "A point of its surface."},
             [](const SceneNode& node, C& c) { c.shape.point = read_vector(node); }),
      key<C>({"normal", "vector", "", "required for a half_space",
              "Out of it, to where the bodies are; its length does not matter."},
             [](const SceneNode& node, C& c) {
               c.shape.normal = read_vector(node);
               if (!(c.shape.normal.norm() > 0)) node.fail("a direction other than zero");
             }),
      key<C>({"center", "vector", "m", "required for a sphere", "Its centre at the start."},
             [](const SceneNode& node, C& c) { c.shape.center = read_vector(node); }),
      key<C>({"radius", "number > 0", "m", "required for a sphere", "Bodies stay outside."},
             [](const SceneNode& node, C& c) { c.shape.radius = read_number(node, positive); }),
      vector_key("velocity", &C::velocity, "m/s", "It moves at this speed ..."),
      key<C>({"until", "number >= 0", "s", "the end", "... until this time, and then stays."},
             [](const SceneNode& node, C& c) { c.until = read_number(node, not_negative); }),
      key<C>({"activation_distance", "number > 0", "m", "0.005 of the smallest body's extent",
              "From here on it is felt; bodies rest at about half of it."},
             [](const SceneNode& node, C& c) { c.activation_distance = read_number(node, positive); }),
      key<C>({"stiffness", "number > 0", "Pa", "0.1 of each body's Young's modulus",
              "Pressure at about half the activation distance; a stiffer one lets bodies come less near."},
             [](const SceneNode& node, C& c) { c.stiffness = read_number(node, positive); }),
      key<C>({"friction", "0", "", "0", "Bodies slide freely; another coefficient is refused."},
             [](const SceneNode& node, C&) {
               if (read_number(node, not_negative) > 0)
                 refuse_later(node, "bodies slide along colliders freely: leave it out or set it to 0");
             }),
  };
}

void read_collider(const SceneNode& node, ColliderDescription& collider) {
  collider.place = node.place();
  collider.name = node.path;
  read_table(node, collider_keys(), collider);
  for (const ShapeKind& kind : shape_kinds()) {
    const bool is_this = kind.name == collider.kind;
    for (const std::string& name : kind.keys) {
      if (is_this && !node.has(name))
        node.fail_with("a " + collider.kind + " needs the key \"" + name + "\"");
      if (!is_this && node.has(name))
        node.child(name).fail_with("is a key of a " + std::string(kind.name) + ", not of a " + collider.kind);
    }
  }
}

}  // namespace resilin
