#include "resilin/element/catalog.hpp"
#include "resilin/io/mesh_file.hpp"
#include "resilin/mesh/generators.hpp"
#include "resilin/mesh/surface_lattice.hpp"
#include "resilin/scene/mesh_cache.hpp"
#include "resilin/scene/tables.hpp"

namespace resilin {
namespace {

struct BoxDescription {
  std::string kind;  ///< kind of its cells; empty: tetrahedra or, in 2D, triangles
  Vector3 size = Vector3::Ones();
  std::array<int, 3> cells = {1, 1, 1};
  Vector3 origin = Vector3::Zero();
};

std::string simplices(int dim) { return dim == 3 ? "tetrahedra" : "triangles"; }

std::vector<std::string> box_kinds(int dim) {
  return {simplices(dim), dim == 3 ? "hexahedra" : "quadrilaterals"};
}

void read_cells(const SceneNode& node, BoxDescription& box) {
  const int dim = node.context->dimension;
  expect_list(node, "whole numbers, one for each direction", dim);
  std::int64_t count = !box.kind.empty() && box.kind != simplices(dim) ? 1 : dim == 3 ? 6 : 2;
  for (int i = 0; i < dim; ++i) {
    const int cells = read_integer(node.element(static_cast<std::size_t>(i)), at_least_one);
    box.cells[static_cast<std::size_t>(i)] = cells;
    if (cells > node.context->max_box_cells / count) {
      node.fail_with("expected at most " + std::to_string(node.context->max_box_cells) +
                     " cells, got more; use fewer cells");
    }
    count *= cells;
  }
}

Keys<BoxDescription> box_keys() {
  using B = BoxDescription;
  return {
      key<B>({"kind", one_of(box_kinds(3)) + ", in 2D " + one_of(box_kinds(2)), "", "the first",
              "Kind of cells."},
             [](const SceneNode& node, B& b) {
               b.kind = read_choice(node, box_kinds(node.context->dimension));
             }),
      key<B>({"size", "vector > 0", "m", "required", "Edge lengths."},
             [](const SceneNode& node, B& b) {
               b.size = read_vector(node);
               for (int i = 0; i < node.context->dimension; ++i) {
                 if (!(b.size[i] > 0))
                   node.fail_with("expected lengths > 0, got " + format_number(b.size[i]));
               }
             }),
      key<B>({"cells", "vector of whole numbers >= 1", "", "required",
              "Cubes along each direction, each cut into 6 tetrahedra; squares cut into 2 triangles in 2D. "
              "Hexahedra and quadrilaterals are not cut."},
             read_cells),
      vector_key("origin", &B::origin, "m", "Corner with the smallest coordinates."),
  };
}

Mesh read_box(const SceneNode& node) {
  BoxDescription box;
  read_table(node, box_keys(), box);
  const std::array<int, 2> squares = {box.cells[0], box.cells[1]};
  if (box.kind == "hexahedra") return make_hexahedron_box(box.size, box.cells, box.origin);
  if (box.kind == "quadrilaterals")
    return make_quadrilateral_rectangle(box.size.head<2>(), squares, box.origin.head<2>());
  if (node.context->dimension == 3) return make_box(box.size, box.cells, box.origin);
  return make_rectangle(box.size.head<2>(), squares, box.origin.head<2>());
}

/// Keys of a table about a body's mesh.
struct MeshTable {
  std::optional<Mesh> box;
  std::optional<MeshFile> surface;
  SurfaceCells cells;
};

/// A file, or the mesh that a program hands over.
MeshFile read_file_of(const SceneNode& node) {
  if (const auto* mesh = std::get_if<SceneValue::MeshHandle>(&node.value->data)) return **mesh;
  const std::filesystem::path path = read_path(node);
  return node.context->meshes != nullptr ? *node.context->meshes->read(path) : read_mesh(path);
}

Keys<MeshTable> mesh_keys() {
  using M = MeshTable;
  return {
      key<M>({"box", "table", "", "",
              "A box (a rectangle in 2D) with the groups `x_min`, `x_max`, `y_min`, ..."},
             [](const SceneNode& node, M& m) { m.box = read_box(node); }),
      key<M>(
          {"surface", "text", "", "",
           "In place of a box: a file with the surface of a body. Tetrahedra fill it, and it becomes the "
           "embedded skin ([skin.md](skin.md#from-a-surface-alone)). The name of such a file alone means the "
           "same."},
          [](const SceneNode& node, M& m) { m.surface = read_file_of(node); }),
      key<M>({"cells", "whole number >= 1", "", default_text(M{}.cells.cells),
              "Approximate number of tetrahedra in a surface."},
             [](const SceneNode& node, M& m) {
               m.cells.cells = read_integer(node, {.min = 1, .max = LatticeOptions::most_cells});
             }),
      key<M>({"mesher", one_of(surface_meshers()), "", default_text(M{}.cells.mesher),
              "How tetrahedra fill a surface: `fitted` ones end at it and keep its sharp edges; those of a "
              "`lattice` are congruent and stand out of it. `auto`: `fitted`, a lattice in `resilin view`."},
             [](const SceneNode& node, M& m) { m.cells.mesher = read_choice(node, surface_meshers()); }),
  };
}

void read_mesh_table(const SceneNode& node, BodyDescription& body) {
  if (node.has("box") == node.has("surface"))
    node.fail(
        "either { box = { size, cells } } or { surface = FILE, cells = NUMBER }, or the name of a mesh file");
  if (node.has("box") && node.has("cells"))
    node.child("cells").fail_with("is for a surface; a box has its own, box.cells");
  if (node.has("box") && node.has("mesher")) node.child("mesher").fail_with("is for a surface");
  MeshTable table;
  read_table(node, mesh_keys(), table);
  if (table.box) {
    body.mesh_name = "box";
    body.mesh = std::move(*table.box);
    return;
  }
  const SceneNode surface = node.child("surface");
  const bool is_text = std::holds_alternative<std::string>(surface.value->data);
  body.mesh_name = is_text ? read_text(surface) : table.surface->numbering.file;
  for (const std::string& warning : table.surface->warnings) node.context->warnings.push_back(warning);
  fill_surface(node, *table.surface, table.cells, body);
}

/// The mesh of a file of cells.
Mesh prepared(const SceneNode& node, MeshFile file, bool uses_corners_only) {
  if (uses_corners_only) resilin::use_corners_only(file);
  prepare_solid_mesh(file, node.context->dimension);
  for (const std::string& warning : file.warnings) node.context->warnings.push_back(warning);
  return std::move(file.mesh);
}

}  // namespace

void read_body_mesh(const SceneNode& node, BodyDescription& body) {
  if (node.value->is_table()) return read_mesh_table(node, body);
  if (const auto* mesh = std::get_if<SceneValue::MeshHandle>(&node.value->data)) {
    body.mesh_name = (*mesh)->numbering.file;
  } else if (std::holds_alternative<std::string>(node.value->data)) {
    body.mesh_name = read_text(node);
  } else {
    node.fail("the name of a mesh file, { box = { size, cells } } or { surface = FILE, cells = NUMBER }");
  }
  MeshFile file = read_file_of(node);
  if (file.is_surface && node.context->dimension == 3) {
    for (const std::string& warning : file.warnings) node.context->warnings.push_back(warning);
    return fill_surface(node, file, {}, body);
  }
  const ElementInfo* element = find_element(body.element, node.context->dimension);
  body.mesh = prepared(node, std::move(file), element != nullptr && element->degree == 1);
}

TableDoc mesh_doc() {
  TableDoc doc = document("mesh", "A file ([formats](mesh_formats.md)), or a table with", mesh_keys());
  for (const Key<BoxDescription>& key : box_keys()) {
    doc.keys.push_back(key.doc);
    doc.keys.back().name = "box." + key.doc.name;
  }
  return doc;
}

}  // namespace resilin
