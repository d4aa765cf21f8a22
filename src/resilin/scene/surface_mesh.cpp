#include "resilin/core/error.hpp"
#include "resilin/mesh/edit.hpp"
#include "resilin/mesh/refine_surface.hpp"
#include "resilin/mesh/surface_lattice.hpp"
#include "resilin/scene/tables.hpp"

namespace resilin {
namespace {

constexpr double largest_usual = 10;           // [m]
constexpr double largest_usual_of_cells = 30;  // [m]; meshes are also made by programs that mean metres
constexpr double smallest_usual = 1e-3;        // [m]
constexpr double heavier = 1.05;               // lattice by surface: from there on it is told

}  // namespace

void enclose_surface(const SceneNode& node, const MeshFile& file, int cells, BodyDescription& body) {
  const std::string& name = file.numbering.file;
  if (node.context->dimension != 3)
    throw InputError(node.place(), "cells of the plane in a scene of dimension 2", "the surface " + name);
  MeshFile facets = file;
  prepare_surface(facets);
  Mesh surface = std::move(facets.mesh);
  check_surface(surface, facets.numbering).require_no_errors();
  SurfaceLattice lattice = make_surface_lattice(surface, name, {.cells = cells});
  for (const std::string& remark : lattice.remarks) node.context->warnings.push_back(remark);
  if (lattice.volume_ratio > heavier)
    node.context->warnings.push_back(
        name + ": " + std::to_string(lattice.mesh.blocks[0].num_cells()) + " cells around it have " +
        format_short(lattice.volume_ratio) +
        " times its volume, mass and stiffness; use more cells for a closer fit (docs/skin.md)");
  body.mesh = std::move(lattice.mesh);
  body.skin.emplace();
  body.skin->place = node.place();
  refine_surface(surface, lattice.spacing);  // so that it bends with the cells
  body.skin->surface = std::move(surface);
  body.skin->surface_name = body.mesh_name;
}

void remark_on_unit(const SceneNode& body_node, const BodyDescription& body) {
  const SceneNode node = body_node.child("mesh");
  if (node.value->is_table() && !node.has("surface")) return;  // a box is in metres
  const bool is_surface = body.skin && body.skin->place == node.place();
  const BoundingBox box = bounding_box(is_surface ? body.skin->surface : body.mesh);
  const double extent = body.scale * (box.max - box.min).maxCoeff();
  const double largest = is_surface ? largest_usual : largest_usual_of_cells;
  if ((extent >= smallest_usual || !is_surface) && extent <= largest) return;
  node.warn(body.mesh_name + " is " + format_short(extent) +
            " m long: mesh files have no unit and are read as metres; use scale = 0.001 for millimetres");
}

}  // namespace resilin
