#include <cmath>

#include "resilin/core/error.hpp"
#include "resilin/element/catalog.hpp"
#include "resilin/mesh/edit.hpp"
#include "resilin/mesh/fitted_mesh.hpp"
#include "resilin/mesh/refine_surface.hpp"
#include "resilin/mesh/surface_groups.hpp"
#include "resilin/mesh/surface_lattice.hpp"
#include "resilin/scene/tables.hpp"

namespace resilin {
namespace {

constexpr double largest_usual = 10;           // [m]
constexpr double largest_usual_of_cells = 30;  // [m]; meshes are also made by programs that mean metres
constexpr double smallest_usual = 1e-3;        // [m]
constexpr double worth_telling = 0.02;         // difference of volume that is worth telling

/// Result of either mesher.
struct FilledSurface {
  Mesh mesh;
  double cell_size = 0;     ///< [m]
  double volume_ratio = 0;  ///< volume ratio of the cells to the surface; 0 when it is not known
  bool is_fitted = false;
};

FilledSurface fill_by_lattice(const SceneNode& node, const Mesh& surface, const std::string& name,
                              int cells) {
  SurfaceLattice lattice = make_surface_lattice(surface, name, {.cells = cells});
  for (const std::string& remark : lattice.remarks) node.context->warnings.push_back(remark);
  return {std::move(lattice.mesh), lattice.spacing, lattice.volume_ratio, false};
}

FilledSurface fill_by_fitting(const SceneNode& node, const Mesh& surface, const std::string& name,
                              const SurfaceCells& wanted, bool is_quadratic) {
  FittedMesh fitted = make_fitted_mesh(surface, name,
                                       {.cells = wanted.cells,
                                        .size = wanted.size,
                                        .min_size = wanted.min_size,
                                        .is_quadratic = is_quadratic});
  for (const std::string& remark : fitted.remarks) node.context->warnings.push_back(remark);
  return {std::move(fitted.mesh), fitted.cell_size, fitted.volume_ratio, true};
}

/// A surface that is no body is refused by both meshers in the same words; one that cannot be followed gets a
/// lattice, unless the scene asks for fitted cells.
FilledSurface fill(const SceneNode& node, const Mesh& surface, const std::string& name,
                   const SurfaceCells& wanted, bool is_quadratic) {
  const bool is_lattice =
      wanted.mesher == "lattice" || (wanted.mesher == "auto" && node.context->is_for_real_time);
  if (is_lattice && wanted.size > 0 && wanted.mesher == "lattice")
    node.child("size").fail_with("is for fitted cells; a lattice has cells");
  if (is_lattice && wanted.min_size > 0 && wanted.mesher == "lattice")
    node.child("min_size").fail_with("is for fitted cells; those of a lattice are congruent");
  if (wanted.size > 0 && wanted.min_size > wanted.size)
    node.child("min_size").fail("at most the size, " + format_short(wanted.size));
  if (is_lattice) return fill_by_lattice(node, surface, name, wanted.cells);
  if (wanted.mesher == "fitted") return fill_by_fitting(node, surface, name, wanted, is_quadratic);
  try {
    return fill_by_fitting(node, surface, name, wanted, is_quadratic);
  } catch (const InputError& error) {
    if (wanted.size > 0) throw;
    FilledSurface filled = fill_by_lattice(node, surface, name, wanted.cells);
    node.context->warnings.push_back(std::string(error.what()) + "; a lattice fills it");
    return filled;
  }
}

}  // namespace

std::vector<std::string> surface_meshers() { return {"auto", "fitted", "lattice"}; }

void fill_surface(const SceneNode& node, const MeshFile& file, const SurfaceCells& wanted,
                  BodyDescription& body) {
  const std::string& name = file.numbering.file;
  if (node.context->dimension != 3)
    throw InputError(node.place(), "cells of the plane in a scene of dimension 2", "the surface " + name);
  MeshFile facets = file;
  prepare_surface(facets);
  Mesh surface = std::move(facets.mesh);
  check_surface(surface, facets.numbering).require_no_errors();
  const ElementInfo* element = find_element(body.element, 3);
  // Cells of a rigid body are linear: straight ones whose sides fit the surface have its mass.
  const bool is_quadratic = !body.rigid && (element == nullptr || element->degree == 2);
  FilledSurface filled = fill(node, surface, name, wanted, is_quadratic);
  const double ratio = filled.volume_ratio;
  if (ratio > 0 && std::abs(ratio - 1) > worth_telling)
    node.context->warnings.push_back(
        "the mesh has " + format_short(ratio) + " times the volume of the surface " + name + " (" +
        std::to_string(filled.mesh.blocks[0].num_cells()) + " cells), and mass and stiffness accordingly; " +
        (filled.is_fitted ? "more cells come nearer" : "mesher = \"fitted\" follows the surface") +
        " (docs/skin.md)");
  body.mesh = std::move(filled.mesh);
  carry_groups(surface, body.mesh);
  body.skin.emplace();
  body.skin->place = node.place();
  refine_surface(surface, filled.cell_size);  // so that it bends with the cells
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
