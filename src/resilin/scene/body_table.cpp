#include <algorithm>

#include "resilin/element/catalog.hpp"
#include "resilin/scene/tables.hpp"

namespace resilin {
namespace {

/// Numbers of one row for each vertex.
std::vector<double> read_vertex_table(const SceneNode& node, const Mesh& mesh) {
  return read_rows(node, mesh.vertices.size(), static_cast<std::size_t>(node.context->dimension),
                   "vertex of the mesh")
      .values;
}

std::vector<std::string> element_names() {
  std::vector<std::string> names = {"auto"};
  for (const ElementInfo* element : elements()) {
    if (std::ranges::find(names, element->name) == names.end()) names.emplace_back(element->name);
  }
  return names;
}

std::vector<std::string> quadrature_names() {
  std::vector<std::string> names;
  for (const ElementInfo* element : elements()) {
    for (const std::string& name : element->quadrature_names()) {
      if (std::ranges::find(names, name) == names.end()) names.push_back(name);
    }
  }
  return names;
}

}  // namespace

Keys<BodyDescription> body_keys() {
  using B = BodyDescription;
  return {
      text_key("name", &B::name, "\"body\"", "Fixes, loads, probes and the report refer to it."),
      choice_key("element", &B::element, element_names(), {},
                 "[Shape functions](#element). auto: P2P0 (Q1P0) where Poisson's ratio is above 0.45, else "
                 "P2 (Q1 on "
                 "quadrilaterals and hexahedra), at rest, in motion and on the page alike; the report says "
                 "which and "
                 "why ([theory](theory/discretisation.md))."),
      key<B>(
          {"quadrature", one_of(quadrature_names()), "", "the element's own",
           "Rule of the points at which the energy is sampled, one of the [element](#element)'s; exact has "
           "no error but rounding for smooth energies."},
          [](const SceneNode& node, B& b) { b.quadrature = read_choice(node, quadrature_names()); }),
      key<B>({"mesh", "text or [table](#mesh)", "", "required",
              "A mesh file beside the scene, `{ box = { size, cells } }` or `{ surface = FILE, cells = "
              "NUMBER }`; a "
              "surface is enclosed by cells and carried as skin."},
             read_body_mesh),
      key<B>({"material", "[material](#material)", "", "see there", "What the body is made of."},
             [](const SceneNode& node, B& b) { read_material(node, b.mesh, b.material); }),
      number_key("scale", &B::scale, "", positive, "Factor on the mesh's coordinates; first."),
      key<B>({"rotate", "[rotate](#rotate)", "", "none", "Turns the scaled mesh, about the origin; second."},
             [](const SceneNode& node, B& b) { read_rotation(node, b.rotate); }),
      vector_key("translate", &B::translate, "m", "Moves the turned mesh; third."),
      vector_key("velocity", &B::velocity, "m/s", "At the start of motion."),
      matrix_key("velocity_gradient", &B::velocity_gradient, "1/s",
                 "Adds velocity_gradient * X, X the rest position."),
      key<B>({"initial_positions", "text or rows", "m", "the rest shape",
              "A CSV file, or a list, of one row for each vertex: where the body starts."},
             [](const SceneNode& node, B& b) { b.initial_positions = read_vertex_table(node, b.mesh); }),
      key<B>(
          {"initial_velocities", "text or rows", "m/s", "from velocity and velocity_gradient",
           "A CSV file, or a list, of one row for each vertex, in place of velocity and velocity_gradient."},
          [](const SceneNode& node, B& b) { b.initial_velocities = read_vertex_table(node, b.mesh); }),
      choice_key("mass", &B::mass, "How mass is spread over the vertices."),
      key<B>({"damping", "[damping](#damping)", "", "none", "In motion: forces against the velocity."},
             [](const SceneNode& node, B& b) { read_damping(node, b.damping); }),
      key<B>({"skin", "text or [skin](#skin)", "", "none",
              "A fine surface that the cells carry, placed with the mesh; the page draws it."},
             [](const SceneNode& node, B& b) { read_skin(node, b.skin); }),
      choice_key(
          "contact_surface", &B::contact_surface,
          "With which surface the body meets others, itself and colliders ([skin.md](skin.md#contact)): "
          "that of its cells, or its skin."),
  };
}

TableDoc element_doc() {
  std::string text =
      "Shape functions on the cells of a body. Elements with one pressure are for nearly incompressible "
      "solids.\n\n| element | dimension | shape functions | nodes | quadrature | other rules |\n"
      "| --- | --- | --- | --- | --- | --- |";
  for (const ElementInfo* element : elements()) {
    std::vector<std::string> others = element->quadrature_names();
    std::erase(others, element->default_quadrature);
    text.append("\n| ").append(element->name).append(" | ").append(std::to_string(element->dim));
    text.append(" | ").append(element->text).append(" | ").append(std::to_string(element->num_nodes));
    text.append(" | ").append(element->default_quadrature).append(" | ").append(join(others)).append(" |");
  }
  return {"element", text, {}};
}

void read_body(const SceneNode& node, BodyDescription& body) {
  body.place = node.place();
  body.material.place = node.place() + ".material";
  read_table(node, body_keys(), body);
  remark_on_unit(node, body);
  if (node.has("initial_velocities") && (node.has("velocity") || node.has("velocity_gradient"))) {
    node.child("initial_velocities")
        .fail_with("comes in place of velocity and velocity_gradient; leave out one or the other");
  }
}

}  // namespace resilin
