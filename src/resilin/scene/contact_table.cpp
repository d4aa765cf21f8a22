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
      key<P>({"bodies", "list of 2 texts", "", "required",
              "Contact pair: the names of two bodies, or one name twice for self-contact."},
             [](const SceneNode& node, P& pair) {
               expect_list(node, "names of bodies", 2);
               for (std::size_t i = 0; i < 2; ++i) pair.bodies[i] = read_text(node.element(i));
             }),
      key<P>({"enabled", "true or false", "", default_text(P{}.is_enabled),
              "Whether contact acts between them."},
             [](const SceneNode& node, P& pair) { pair.is_enabled = read_flag(node); }),
      key<P>(
          {"friction", "number >= 0", "", "contact.friction", "Coulomb friction coefficient of this pair."},
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
              "Contact between bodies; without it they pass through each other."},
             [](const SceneNode& node, C& c) { c.is_enabled = read_flag(node); }),
      key<C>({"self", "true or false", "", default_text(C{}.with_themselves), "Self-contact of each body."},
             [](const SceneNode& node, C& c) { c.with_themselves = read_flag(node); }),
      key<C>({"activation_distance", "number > 0", "m",
              "0.005 of the smallest body's extent, at most 0.1 of the thinnest's thickness and the mean "
              "side of a contact [skin](skin.md#contact); with `self` at most half the thinnest gap",
              "Activation distance of the contact barrier (dhat); bodies rest at about half of it."},
             [](const SceneNode& node, C& c) { c.activation_distance = read_number(node, positive); }),
      key<C>({"stiffness", "number > 0", "Pa", "the softer body's Young's modulus",
              "Barrier stiffness: pressure at about half the activation distance; a larger value gives "
              "larger gaps."},
             [](const SceneNode& node, C& c) { c.stiffness = read_number(node, positive); }),
      number_key("friction", &C::friction, "", not_negative,
                 "Coulomb friction coefficient between bodies and in self-contact."),
      key<C>({"friction_speed", "number > 0", "m/s", "0.001 of the smallest body's extent per second",
              "Regularisation of stick: bodies that stick creep at up to this speed, on colliders too."},
             [](const SceneNode& node, C& c) { c.friction_speed = read_number(node, positive); }),
      integer_key("friction_iterations", &C::friction_iterations, not_negative,
                  "Limit of lagged friction iterations per step; a step ends as soon as they converge."),
      key<C>({"pair", "[[contact.pair]]", "", "none", "Contact pairs with other settings."},
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
                  "A contact pair (two bodies, or a body and itself) with its own settings.",
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
      key<T>({"axis", "vector", "", default_text(T{}.axis), "Rotation axis; only in 3D."},
             [](const SceneNode& node, T& t) {
               if (node.context->dimension == 2) node.fail_with("a rotation in 2D has no axis; leave it out");
               t.axis = read_vector(node);
               if (!(t.axis.norm() > 0)) node.fail("a direction", "it has no length");
             }),
      vector_key("center", &T::center, "m",
                 "A point of the axis at the start; the axis moves with the collider."),
      number_key("degrees", &T::degrees, "degrees", any_number,
                 "Initial angle, counter-clockwise if the axis points at you."),
      number_key("degrees_per_second", &T::degrees_per_second, "degrees/s", any_number, "Angular velocity."),
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
  return document("collider.rotate", "Rotation of a collider while it moves.", turn_keys());
}

Keys<ColliderDescription> collider_keys() {
  using C = ColliderDescription;
  std::vector<std::string> kinds;
  for (const ShapeKind& kind : shape_kinds()) kinds.emplace_back(kind.name);
  return {
      text_key("name", &C::name, "collider[0] ...", "Name of the contact force in the report."),
      {.doc = {"kind", one_of(kinds), "", "required",
               "A half_space fills one side of a plane (2D: a line); a capsule has round ends, a cylinder "
               "flat ones (only in 3D); a mesh consists of triangles, edges and points."},
       .read = [kinds](const SceneNode& node, C& c) { c.kind = read_choice(node, kinds); },
       .is_required = true},
      key<C>({"point", "vector", "m", "required for a half_space", "A point on its surface."},
             [](const SceneNode& node, C& c) { c.shape.point = read_vector(node); }),
      key<C>({"normal", "vector", "", "required for a half_space",
              "Outward normal, towards the bodies, of any length."},
             [](const SceneNode& node, C& c) {
               c.shape.normal = read_vector(node);
               if (!(c.shape.normal.norm() > 0)) node.fail("a direction other than zero");
             }),
      key<C>({"center", "vector", "m", "required for a sphere and a box", "Initial centre."},
             [](const SceneNode& node, C& c) { c.shape.center = read_vector(node); }),
      key<C>({"radius", "number > 0", "m", "required for a sphere, a capsule and a cylinder", "Radius."},
             [](const SceneNode& node, C& c) { c.shape.radius = read_number(node, positive); }),
      key<C>({"size", "vector > 0", "m", "required for a box", "Edge lengths."},
             [](const SceneNode& node, C& c) {
               c.shape.size = read_vector(node);
               for (int i = 0; i < node.context->dimension; ++i)
                 if (!(c.shape.size[i] > 0))
                   node.fail_with("expected lengths > 0, got " + format_number(c.shape.size[i]));
             }),
      key<C>({"start", "vector", "m", "required for a capsule and a cylinder", "Start point of its axis."},
             [](const SceneNode& node, C& c) { c.shape.start = read_vector(node); }),
      key<C>({"end", "vector", "m", "required for a capsule and a cylinder", "End point of its axis."},
             [](const SceneNode& node, C& c) { c.shape.end = read_vector(node); }),
      key<C>({"mesh", "text", "", "required for a mesh",
              "A [file](mesh_formats.md) of triangles, lines or points (in 2D lines or points); a solid mesh "
              "counts "
              "by its surface."},
             read_collider_mesh),
      key<C>({"scale", "number > 0", "", default_text(C{}.shape.scale),
              "Scale factor of the mesh, about the origin."},
             [](const SceneNode& node, C& c) { c.shape.scale = read_number(node, positive); }),
      key<C>({"translate", "vector", "m", default_text(C{}.shape.translate),
              "Translation of the mesh, after scale."},
             [](const SceneNode& node, C& c) { c.shape.translate = read_vector(node); }),
      vector_key("velocity", &C::velocity, "m/s", "Velocity ..."),
      key<C>({"rotate", "[table](#colliderrotate)", "", "none", "... and rotation ..."},
             [](const SceneNode& node, C& c) { read_table(node, turn_keys(), c.rotate.emplace()); }),
      key<C>({"until", "number >= 0", "s", "the end", "... until this time."},
             [](const SceneNode& node, C& c) { c.until = read_number(node, not_negative); }),
      vector_key("displacement", &C::displacement, "m",
                 "Additional displacement, linear in time up to the end, or times a function of time."),
      key<C>({"time_function", "[time_function](#time_function)", "", "linear up to the end",
              "Factor on displacement."},
             [](const SceneNode& node, C& c) { read_time_function(node, c.time_function); }),
      key<C>({"activation_distance", "number > 0", "m",
              "0.005 of the smallest body's extent, at most 0.1 of the thinnest's thickness",
              "Activation distance of the barrier (dhat); bodies rest at about half of it."},
             [](const SceneNode& node, C& c) { c.activation_distance = read_number(node, positive); }),
      key<C>({"stiffness", "number > 0", "Pa", "0.1 of each body's Young's modulus",
              "Barrier stiffness: pressure at about half the activation distance; a larger value gives "
              "larger gaps."},
             [](const SceneNode& node, C& c) { c.stiffness = read_number(node, positive); }),
      number_key("friction", &C::friction, "", not_negative,
                 "Coulomb friction coefficient: the largest tangential over normal force; bodies stick below "
                 "it and slip at it."),
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
