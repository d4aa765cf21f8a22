#include "resilin/element/catalog.hpp"
#include "resilin/io/mesh_file.hpp"
#include "resilin/mesh/generators.hpp"
#include "resilin/mesh/round_generators.hpp"
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

/// A round body as a scene gives it.
struct RoundTable {
  RoundShape shape;
  std::string kind;  ///< kind of its cells; empty: the one that suits the element
  std::vector<int> cells;
  Vector3 center = Vector3::Zero();
};

void read_radii(const SceneNode& node, RoundTable& round) {
  expect_list(node, "two lengths [inner, outer]", 2);
  round.shape.inner_radius = read_number(node.element(0), positive);
  round.shape.radius = read_number(node.element(1), positive);
  if (round.shape.inner_radius >= round.shape.radius)
    node.fail_with("expected [inner, outer] with inner < outer");
}

void read_counts(const SceneNode& node, RoundTable& round) {
  if (!node.value->is_array()) {
    round.cells = {read_integer(node, at_least_one)};
    return;
  }
  expect_list(node, "whole numbers");
  for (std::size_t i = 0; i < node.value->array().size(); ++i)
    round.cells.push_back(read_integer(node.element(i), at_least_one));
}

Keys<RoundTable> round_keys() {
  using R = RoundTable;
  return {
      key<R>({"kind", one_of(box_kinds(3)) + ", in 2D " + one_of(box_kinds(2)), "", "the first",
              "Kind of cells; with element Q1 or Q1P0 the second."},
             [](const SceneNode& node, R& r) {
               r.kind = read_choice(node, box_kinds(node.context->dimension));
             }),
      key<R>({"radius", "number > 0", "m", "", "disc, cylinder, ball: the radius."},
             [](const SceneNode& node, R& r) { r.shape.radius = read_number(node, positive); }),
      key<R>({"radii", "[inner, outer]", "m", "", "ring, tube, spherical_shell: both radii."}, read_radii),
      key<R>({"height", "number > 0", "m", "", "cylinder, tube: along z, from the plane z = 0 on."},
             [](const SceneNode& node, R& r) { r.shape.height = read_number(node, positive); }),
      key<R>({"cells", "one or more whole numbers", "", "required",
              "disc, ball: number along the radius. cylinder: [radius, height]. ring: [wall, circle]. tube: "
              "[wall, "
              "circle, height]. spherical_shell: [wall, circle], the latter rounded up to a multiple of 4."},
             read_counts),
      key<R>({"degrees", "number > 0", "degrees", "360",
              "ring, tube: how much of the circle there is, from x on."},
             [](const SceneNode& node, R& r) { r.shape.degrees = read_number(node, positive); }),
      key<R>({"grading", "number > 0", "", "1",
              "Thickness of the outermost cell by that of the innermost one; of a disc, cylinder and ball "
              "outside of "
              "their cores."},
             [](const SceneNode& node, R& r) { r.shape.grading = read_number(node, positive); }),
      vector_key("center", &R::center, "m", "Its centre; of a cylinder and tube that of the bottom."),
  };
}

/// @param element  of the body; null for auto
Mesh read_round(const SceneNode& node, RoundKind kind, const ElementInfo* element) {
  if (dimension(kind) != node.context->dimension)
    node.fail_with("a " + spelling(kind) + " belongs to a scene of dimension " +
                   std::to_string(dimension(kind)));
  RoundTable round;
  round.shape.kind = kind;
  read_table(node, round_keys(), round);
  const auto require = [&](const std::string& name, bool is_needed) {
    if (node.has(name) == is_needed) return;
    const std::string text =
        "a " + spelling(kind) + (is_needed ? " needs the key \"" : " has no key \"") + name + "\"";
    if (is_needed) node.fail_with(text);
    node.child(name).fail_with(text);
  };
  RoundShape& shape = round.shape;
  require("radii", has_hole(kind));
  require("radius", !has_hole(kind));
  require("height", has_height(kind));
  if (node.has("degrees") && (!has_hole(kind) || kind == RoundKind::spherical_shell))
    require("degrees", false);
  const std::size_t count = 1 + (has_hole(kind) ? 1 : 0) + (has_height(kind) ? 1 : 0);
  if (!node.has("cells") || round.cells.size() != count) {
    const SceneNode& place = node.has("cells") ? node.child("cells") : node;
    place.fail_with("a " + spelling(kind) + " needs " + std::to_string(count) +
                    (count == 1 ? " number" : " numbers") + " of cells: cells = " +
                    (count == 1   ? "4"
                     : count == 2 ? (has_hole(kind) ? "[2, 32]" : "[4, 8]")
                                  : "[2, 32, 8]"));
  }
  shape.radial_cells = round.cells[0];
  if (has_hole(kind)) shape.around_cells = round.cells[1];
  if (has_height(kind)) shape.axial_cells = round.cells.back();
  if (shape.degrees > 360) node.child("degrees").fail("a number up to 360");
  if (has_hole(kind) && shape.around_cells < 3 && shape.degrees > 180)
    node.child("cells").fail_with("expected at least 3 cells along the circle");
  const double whole =
      kind == RoundKind::ball ? 14.0 * std::pow(shape.radial_cells, 3)
      : kind == RoundKind::spherical_shell
          ? 6.0 * std::pow(shape.around_cells / 4 + 1.0, 2) * shape.radial_cells
      : has_hole(kind)
          ? 1.0 * shape.radial_cells * shape.around_cells * (has_height(kind) ? shape.axial_cells : 1)
          : 4.0 * shape.radial_cells * shape.radial_cells * (has_height(kind) ? shape.axial_cells : 1);
  if (6 * whole > static_cast<double>(node.context->max_box_cells))
    node.fail_with("expected at most " + std::to_string(node.context->max_box_cells) +
                   " cells, got more; use fewer cells");
  const bool wants_cubes = element != nullptr && !is_simplex(element->shape);
  shape.is_cut = round.kind.empty() ? !wants_cubes : round.kind == simplices(node.context->dimension);
  shape.is_quadratic = element == nullptr || element->degree == 2;
  Mesh mesh = make_round(shape);
  for (Vector3& vertex : mesh.vertices) vertex += round.center;
  return mesh;
}

/// Keys of a table about a body's mesh.
struct MeshTable {
  const ElementInfo* element = nullptr;  ///< element of the body; null for auto
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
  Keys<M> keys = {
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
      key<M>({"size", "number > 0", "the file's", "by cells",
              "In place of cells: the length of their edges, in the lengths of the file, before scale."},
             [](const SceneNode& node, M& m) { m.cells.size = read_number(node, positive); }),
      key<M>({"min_size", "number > 0", "the file's", "0.4 of the others, on curves",
              "Least length of edges of `fitted` cells. They become shorter down to it where the surface is "
              "curved and where walls are thin, at most twenty times."},
             [](const SceneNode& node, M& m) { m.cells.min_size = read_number(node, positive); }),
      key<M>({"mesher", one_of(surface_meshers()), "", default_text(M{}.cells.mesher),
              "How tetrahedra fill a surface. A `fitted` mesh ends at it and keeps its sharp edges; a "
              "`lattice` has "
              "congruent cells and extends beyond it. `auto`: `fitted`, a lattice in `resilin view`."},
             [](const SceneNode& node, M& m) { m.cells.mesher = read_choice(node, surface_meshers()); }),
  };
  for (std::size_t i = 0; i < spellings(RoundKind{}).size(); ++i) {
    const auto kind = static_cast<RoundKind>(i);
    keys.push_back(
        key<M>({spelling(kind), "table", "", "",
                std::string(dimension(kind) == 2 ? "2D" : "3D") + ", likewise, with the groups `outer`" +
                    (has_hole(kind) ? ", `inner`" : "") + (has_height(kind) ? ", `bottom`, `top`" : "") +
                    ". Quadratic elements lie on the true circle."},
               [kind](const SceneNode& node, M& m) { m.box = read_round(node, kind, m.element); }));
  }
  return keys;
}

void read_mesh_table(const SceneNode& node, BodyDescription& body) {
  std::vector<std::string> shapes = all_spellings<RoundKind>();
  shapes.insert(shapes.begin(), "box");
  std::string shape;
  std::size_t count = node.has("surface") ? 1 : 0;
  for (const std::string& name : shapes)
    if (node.has(name)) {
      shape = name;
      ++count;
    }
  if (count > 1 || (count == 0 && node.value->table().empty()))
    node.fail("one of { surface = FILE, cells = NUMBER } and { " + join(shapes) +
              " = { ... } }, or the name of a mesh file");
  if (!shape.empty() && node.has("cells"))
    node.child("cells").fail_with("is for a surface; a " + shape + " has its own, " + shape + ".cells");
  if (node.has("size") && (node.has("cells") || !shape.empty()))
    node.child("size").fail_with(shape.empty() ? "replaces cells; give one of them" : "is for a surface");
  if (!shape.empty() && node.has("min_size")) node.child("min_size").fail_with("is for a surface");
  if (!shape.empty() && node.has("mesher")) node.child("mesher").fail_with("is for a surface");
  MeshTable table;
  table.element = find_element(body.element, node.context->dimension);
  read_table(node, mesh_keys(), table);
  if (count == 0)
    node.fail("one of { surface = FILE, cells = NUMBER } and { " + join(shapes) +
              " = { ... } }, or the name of a mesh file");
  if (table.box) {
    body.mesh_name = shape;
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
  for (const Key<RoundTable>& key : round_keys()) {
    doc.keys.push_back(key.doc);
    doc.keys.back().name = "disc." + key.doc.name;
  }
  return doc;
}

}  // namespace resilin
