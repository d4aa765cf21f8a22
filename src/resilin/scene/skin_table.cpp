#include "resilin/core/error.hpp"
#include "resilin/io/mesh_file.hpp"
#include "resilin/mesh/edit.hpp"
#include "resilin/scene/tables.hpp"

namespace resilin {
namespace {

void check_facets(const MeshFile& file, const SceneNode& node) {
  const bool has_lines = node.context->dimension == 2 && file.mesh.find_block(CellKind::line) != nullptr;
  if (has_lines && file.mesh.find_block(CellKind::triangle) == nullptr) return;
  const CellBlock* triangles = file.mesh.find_block(CellKind::triangle);
  if (triangles == nullptr || triangles->num_cells() == 0) {
    const bool is_solid = file.mesh.find_solid(3) != nullptr;
    throw InputError(node.place(), "triangles in " + file.numbering.file, "none",
                     is_solid ? "`resilin mesh IN OUT.obj --surface` makes a surface of a solid mesh"
                              : "a skin is a surface, such as an OBJ file");
  }
  Mesh surface = file.mesh;
  surface.blocks = {CellBlock(*triangles)};
  const MeshReport report = check_surface(surface, file.numbering);
  report.require_no_errors();
  for (const MeshIssue& issue : report.warnings) node.context->warnings.push_back(issue.text());
}

void read_surface(const SceneNode& node, SkinDescription& skin) {
  MeshFile file;
  if (const auto* mesh = std::get_if<SceneValue::MeshHandle>(&node.value->data)) {
    file = **mesh;
    skin.surface_name = file.numbering.file;
  } else {
    skin.surface_name = read_text(node);
    file = read_mesh(read_path(node));
  }
  prepare_surface(file);
  check_facets(file, node);
  for (const std::string& warning : file.warnings) node.context->warnings.push_back(warning);
  skin.surface = std::move(file.mesh);
}

Keys<SkinDescription> skin_keys() {
  using S = SkinDescription;
  return {
      key<S>(
          {"surface", "text", "", "required",
           "A file of triangles beside the scene, such as OBJ, STL, PLY or glTF; in 2D triangles or lines in "
           "the plane."},
          read_surface),
      key<S>({"smooth", "true or false", "", default_text(S{}.is_smooth),
              "Smooths the skin between the vertices of the cells, which hides the facets of coarse linear "
              "cells, for twice the work per frame. P2 cells need no smoothing."},
             [](const SceneNode& node, S& s) { s.is_smooth = read_flag(node); }),
  };
}

}  // namespace

void read_skin(const SceneNode& node, std::optional<SkinDescription>& skin) {
  skin.emplace();
  skin->place = node.place();
  if (node.value->is_table()) return read_table(node, skin_keys(), *skin);
  read_surface(node, *skin);
}

TableDoc skin_doc() {
  return document("skin", "An embedded fine surface ([skin.md](skin.md)): a file, or a table with",
                  skin_keys());
}

}  // namespace resilin
