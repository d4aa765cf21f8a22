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

Keys<RigidDescription> rigid_keys() {
  using R = RigidDescription;
  return {
      key<R>({"density", "number > 0", "kg/m^3", "none",
              "Density; required with gravity, in dynamic and modal analysis."},
             [](const SceneNode& node, R& r) { r.density = read_number(node, positive); }),
      key<R>({"stiffness", "number > 0", "Pa", "by what it meets",
              "Young's modulus by which it resists stretching ([rigid bodies](rigid.md#method))."},
             [](const SceneNode& node, R& r) { r.stiffness = read_number(node, positive); }),
  };
}

}  // namespace

void read_rigid(const SceneNode& node, std::optional<RigidDescription>& rigid) {
  if (!node.value->is_table() && !read_flag(node)) return;
  rigid.emplace();
  rigid->place = node.place();
  if (node.value->is_table()) read_table(node, rigid_keys(), *rigid);
}

TableDoc rigid_doc() {
  return document("rigid",
                  "A body or a region that keeps its shape ([rigid bodies](rigid.md)): true, or a table with",
                  rigid_keys());
}

Keys<BodyDescription> body_keys() {
  using B = BodyDescription;
  return {
      text_key("name", &B::name, "\"body\"",
               "Name used by boundary conditions, loads, probes and the report."),
      choice_key("element", &B::element, element_names(), {},
                 "[Finite element](#element). auto: P2P0 (Q1P0) above a Poisson's ratio of 0.45, else P2 (Q1 "
                 "on quadrilaterals and hexahedra); the report says which and why "
                 "([theory](theory/discretisation.md))."),
      key<B>({"quadrature", one_of(quadrature_names()), "", "the element's own",
              "Quadrature rule, one of those of the [element](#element); exact integrates smooth energies up "
              "to round-off."},
             [](const SceneNode& node, B& b) { b.quadrature = read_choice(node, quadrature_names()); }),
      key<B>({"rigid", "true, false or [rigid](#rigid)", "", "false",
              "Keeps the shape of its mesh; in place of material."},
             [](const SceneNode& node, B& b) { read_rigid(node, b.rigid); }),
      key<B>({"mesh", "text or [table](#mesh)", "", "required",
              "A mesh file beside the scene, `{ box = { size, cells } }` or `{ surface = FILE, cells = "
              "NUMBER }`; cells then enclose the surface, which becomes an embedded skin."},
             read_body_mesh),
      key<B>({"material", "[material](#material)", "", "see there", "Constitutive model and density."},
             [](const SceneNode& node, B& b) { read_material(node, b.mesh, b.material); }),
      key<B>({"region", "[[body.region]]", "", "none", "Cells of another material, or rigid ones."},
             [](const SceneNode& node, B& b) { read_regions(node, b.mesh, b.regions); }),
      number_key("scale", &B::scale, "", positive, "Scale factor of the mesh coordinates, applied first."),
      key<B>({"rotate", "[rotate](#rotate)", "", "none",
              "Rotation of the scaled mesh about the origin, applied second."},
             [](const SceneNode& node, B& b) { read_rotation(node, b.rotate); }),
      vector_key("translate", &B::translate, "m", "Translation of the rotated mesh, applied third."),
      vector_key("velocity", &B::velocity, "m/s", "Initial velocity."),
      matrix_key("velocity_gradient", &B::velocity_gradient, "1/s",
                 "Adds velocity_gradient * X to the initial velocity, X the reference position."),
      key<B>({"initial_positions", "text or rows", "m", "the reference positions",
              "Initial positions: a CSV file, or a list, of one row for each vertex."},
             [](const SceneNode& node, B& b) { b.initial_positions = read_vertex_table(node, b.mesh); }),
      key<B>({"initial_velocities", "text or rows", "m/s", "from velocity and velocity_gradient",
              "Initial velocities: a CSV file, or a list, of one row for each vertex, in place of velocity "
              "and velocity_gradient."},
             [](const SceneNode& node, B& b) { b.initial_velocities = read_vertex_table(node, b.mesh); }),
      choice_key("mass", &B::mass, "Mass matrix: lumped or consistent."),
      key<B>({"damping", "[damping](#damping)", "", "none", "Dynamics: damping forces."},
             [](const SceneNode& node, B& b) { read_damping(node, b.damping); }),
      key<B>({"skin", "text or [skin](#skin)", "", "none",
              "Embedded fine surface, transformed with the mesh; the page draws it."},
             [](const SceneNode& node, B& b) { read_skin(node, b.skin); }),
      choice_key("contact_surface", &B::contact_surface,
                 "Contact surface of the body ([skin.md](skin.md#contact)): the boundary of its cells, or "
                 "its skin."),
  };
}

TableDoc element_doc() {
  std::string text =
      "Finite elements of a body. Mixed displacement-pressure elements are for nearly incompressible "
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
  if (body.rigid && node.has("material"))
    node.child("material").fail_with("is for a deformable body; a rigid one has rigid = { density = 7800 }");
  remark_on_unit(node, body);
  if (node.has("initial_velocities") && (node.has("velocity") || node.has("velocity_gradient"))) {
    node.child("initial_velocities")
        .fail_with("replaces velocity and velocity_gradient; give one or the other");
  }
}

}  // namespace resilin
