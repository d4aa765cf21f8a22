#include <algorithm>
#include <map>

#include "resilin/contact/catalog.hpp"
#include "resilin/io/mesh_file.hpp"
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
      key<P>({"friction", "number >= 0", "", "contact.friction", "Coulomb's coefficient of these two."},
             [](const SceneNode& node, P& pair) { pair.friction = read_number(node, not_negative); }),
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
              "0.005 of the smallest body's extent, at most 0.1 of the thinnest's thickness and the mean "
              "side of a "
              "[skin](skin.md#contact) that meets; with `self` at most half the thinnest gap",
              "From here on bodies feel each other; they rest at about half of it."},
             [](const SceneNode& node, C& c) { c.activation_distance = read_number(node, positive); }),
      key<C>({"stiffness", "number > 0", "Pa", "the softer body's Young's modulus",
              "Pressure at about half the activation distance; a stiffer one lets bodies come less near."},
             [](const SceneNode& node, C& c) { c.stiffness = read_number(node, positive); }),
      number_key("friction", &C::friction, "", not_negative,
                 "Coulomb's coefficient of bodies on each other and on themselves."),
      key<C>({"friction_speed", "number > 0", "m/s", "0.001 of the smallest body's extent in a second",
              "Bodies that stick creep at up to this speed, on colliders, too."},
             [](const SceneNode& node, C& c) { c.friction_speed = read_number(node, positive); }),
      integer_key(
          "friction_iterations", &C::friction_iterations, not_negative,
          "So often at most a step forms the normal forces of friction anew; it ends once that changes "
          "nothing."),
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

namespace {

Keys<ColliderTurn> turn_keys() {
  using T = ColliderTurn;
  return {
      key<T>({"axis", "vector", "", default_text(T{}.axis), "Direction that the turn is about; only in 3D."},
             [](const SceneNode& node, T& t) {
               if (node.context->dimension == 2) node.fail_with("a turn in 2D has no axis; leave it out");
               t.axis = read_vector(node);
               if (!(t.axis.norm() > 0)) node.fail("a direction", "it has no length");
             }),
      vector_key("center", &T::center, "m", "A point of the axis at the start, which moves along."),
      number_key("degrees", &T::degrees, "degrees", any_number,
                 "Angle at the start, counter-clockwise when the axis points at you."),
      number_key("degrees_per_second", &T::degrees_per_second, "degrees/s", any_number,
                 "It turns on at this speed."),
  };
}

void read_collider_mesh(const SceneNode& node, ColliderDescription& collider) {
  MeshFile file;
  if (const auto* mesh = std::get_if<SceneValue::MeshHandle>(&node.value->data)) {
    file = **mesh;
    collider.shape.mesh_name = file.numbering.file;
  } else {
    collider.shape.mesh_name = read_text(node);
    file = read_mesh(read_path(node));
  }
  for (const std::string& warning : file.warnings) node.context->warnings.push_back(warning);
  collider.shape.mesh = std::move(file.mesh);
}

/// Keys that some kinds have and others do not, with those kinds.
std::map<std::string, std::vector<std::string>> kinds_of_keys() {
  std::map<std::string, std::vector<std::string>> kinds;
  for (const ShapeKind& kind : shape_kinds())
    for (const auto* some : {&kind.keys, &kind.more_keys})
      for (const std::string& key : *some) kinds[key].emplace_back(kind.name);
  return kinds;
}

}  // namespace

TableDoc collider_turn_doc() {
  return document("collider.rotate", "A turn that goes on as long as the collider moves.", turn_keys());
}

Keys<ColliderDescription> collider_keys() {
  using C = ColliderDescription;
  std::vector<std::string> kinds;
  for (const ShapeKind& kind : shape_kinds()) kinds.emplace_back(kind.name);
  return {
      text_key("name", &C::name, "collider[0] ...", "The force on the bodies is reported under it."),
      {.doc =
           {"kind", one_of(kinds), "", "required",
            "A half_space fills one side of a plane (2D: of a line); a capsule is all within a radius of its "
            "axis, a cylinder has flat ends (only in 3D); a mesh is of triangles, edges and points."},
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
      key<C>({"center", "vector", "m", "required for a sphere and a box", "Its centre at the start."},
             [](const SceneNode& node, C& c) { c.shape.center = read_vector(node); }),
      key<C>({"radius", "number > 0", "m", "required for a sphere, a capsule and a cylinder",
              "Bodies stay outside."},
             [](const SceneNode& node, C& c) { c.shape.radius = read_number(node, positive); }),
      key<C>({"size", "vector > 0", "m", "required for a box", "Its edge lengths."},
             [](const SceneNode& node, C& c) {
               c.shape.size = read_vector(node);
               for (int i = 0; i < node.context->dimension; ++i)
                 if (!(c.shape.size[i] > 0))
                   node.fail_with("expected lengths > 0, got " + format_number(c.shape.size[i]));
             }),
      key<C>({"start", "vector", "m", "required for a capsule and a cylinder", "Where its axis begins."},
             [](const SceneNode& node, C& c) { c.shape.start = read_vector(node); }),
      key<C>({"end", "vector", "m", "required for a capsule and a cylinder", "Where its axis ends."},
             [](const SceneNode& node, C& c) { c.shape.end = read_vector(node); }),
      key<C>({"mesh", "text", "", "required for a mesh",
              "A [file](mesh_formats.md) of triangles, lines or points, in 2D of lines or points; of cells "
              "the surface."},
             read_collider_mesh),
      key<C>({"scale", "number > 0", "", default_text(C{}.shape.scale), "Of the mesh, about the origin."},
             [](const SceneNode& node, C& c) { c.shape.scale = read_number(node, positive); }),
      key<C>({"translate", "vector", "m", default_text(C{}.shape.translate), "Of the mesh, after scale."},
             [](const SceneNode& node, C& c) { c.shape.translate = read_vector(node); }),
      vector_key("velocity", &C::velocity, "m/s", "It moves at this speed ..."),
      key<C>({"rotate", "[table](#colliderrotate)", "", "none", "... and turns ..."},
             [](const SceneNode& node, C& c) { read_table(node, turn_keys(), c.rotate.emplace()); }),
      key<C>({"until", "number >= 0", "s", "the end", "... until this time."},
             [](const SceneNode& node, C& c) { c.until = read_number(node, not_negative); }),
      vector_key("displacement", &C::displacement, "m",
                 "It moves by this, too: evenly up to the end, or times a function of time."),
      key<C>({"time_function", "[time_function](#time_function)", "", "evenly up to the end",
              "A factor on displacement."},
             [](const SceneNode& node, C& c) { read_time_function(node, c.time_function); }),
      key<C>({"activation_distance", "number > 0", "m",
              "0.005 of the smallest body's extent, at most 0.1 of the thinnest's thickness",
              "From here on it is felt; bodies rest at about half of it."},
             [](const SceneNode& node, C& c) { c.activation_distance = read_number(node, positive); }),
      key<C>({"stiffness", "number > 0", "Pa", "0.1 of each body's Young's modulus",
              "Pressure at about half the activation distance; a stiffer one lets bodies come less near."},
             [](const SceneNode& node, C& c) { c.stiffness = read_number(node, positive); }),
      number_key(
          "friction", &C::friction, "", not_negative,
          "Coulomb's coefficient: bodies stick where they are pulled along it by less than this part of "
          "what presses them on, and rub where by more."),
  };
}

void read_collider(const SceneNode& node, ColliderDescription& collider) {
  collider.place = node.place();
  collider.name = node.path;
  read_table(node, collider_keys(), collider);
  for (const std::string& name : find_shape_kind(collider.kind)->keys)
    if (!node.has(name)) node.fail_with("a " + collider.kind + " needs the key \"" + name + "\"");
  for (const auto& [name, kinds] : kinds_of_keys()) {
    if (node.has(name) && std::ranges::find(kinds, collider.kind) == kinds.end())
      node.child(name).fail_with("is a key of a " + join(kinds, " or a ") + ", not of a " + collider.kind);
  }
  const bool has_axis = collider.kind == "capsule" || collider.kind == "cylinder";
  if (has_axis && collider.shape.start == collider.shape.end)
    node.child("end").fail("another place than start", "a sphere has no axis");
  if (node.has("time_function") && !node.has("displacement"))
    node.child("time_function").fail_with("is a factor on displacement; give one");
}

}  // namespace resilin
