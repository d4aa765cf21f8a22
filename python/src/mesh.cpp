#include <nanobind/stl/array.h>
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <string>
#include <tuple>
#include <vector>

#include "bindings.hpp"
#include "csr.hpp"
#include "resilin/core/archive.hpp"
#include "resilin/element/catalog.hpp"
#include "resilin/io/mesh_file.hpp"
#include "resilin/mesh/cell_kind.hpp"
#include "resilin/mesh/embedding.hpp"
#include "resilin/mesh/generators.hpp"
#include "resilin/mesh/mesh_members.hpp"
#include "resilin/mesh/second_order.hpp"

namespace resilin {

RESILIN_MEMBERS(Numbering, file, cell_word, first_vertex, first_cell, vertices, cells)
RESILIN_MEMBERS(MeshFile, mesh, numbering, format, warnings, is_surface)

}  // namespace resilin

namespace resilin::python {
namespace {

using Cells = std::vector<std::tuple<CellKind, Array2d<Index>>>;
using VertexGroups = std::vector<std::pair<std::string, Vector1d<Index>>>;

/// @param positions  (N, 2 or 3) [m]
MeshFile make_mesh(const Array2d<double>& positions, const Cells& cells, const VertexGroups& groups,
                   const std::string& name) {
  MeshFile file;
  file.numbering.file = name;
  file.numbering.cell_word = "cell";
  file.mesh.vertices.assign(positions.shape(0), Vector3::Zero());
  for (std::size_t v = 0; v < positions.shape(0); ++v)
    for (std::size_t i = 0; i < positions.shape(1); ++i)
      file.mesh.vertices[v][static_cast<Eigen::Index>(i)] = positions(v, i);
  for (const auto& [kind, nodes] : cells) {
    std::vector<Index>& all = file.mesh.block(kind).nodes;
    all.insert(all.end(), nodes.data(), nodes.data() + nodes.size());
  }
  for (const auto& [group, vertices] : groups) {
    std::vector<Index> sorted(vertices.data(), vertices.data() + vertices.size());
    std::ranges::sort(sorted);
    sorted.erase(std::ranges::unique(sorted).begin(), sorted.end());
    file.mesh.groups.push_back({.name = group, .cells = {}, .vertices = std::move(sorted)});
  }
  return file;
}

MeshFile generated(Mesh mesh, const std::string& name) {
  MeshFile file;
  file.mesh = std::move(mesh);
  file.numbering.file = name;
  file.numbering.cell_word = "cell";
  return file;
}

/// (N, 3) [m]
NumpyArray<double> positions(const MeshFile& file) {
  std::vector<double> values;
  values.reserve(3 * file.mesh.vertices.size());
  for (const Vector3& vertex : file.mesh.vertices) values.insert(values.end(), vertex.begin(), vertex.end());
  return numpy_array(std::move(values), {file.mesh.vertices.size(), 3});
}

std::vector<std::tuple<CellKind, NumpyArray<Index>>> cells(const MeshFile& file) {
  std::vector<std::tuple<CellKind, NumpyArray<Index>>> all;
  for (const CellBlock& block : file.mesh.blocks) {
    const auto columns = static_cast<std::size_t>(num_nodes(block.kind));
    all.emplace_back(block.kind, numpy_array(block.nodes, {block.nodes.size() / columns, columns}));
  }
  return all;
}

std::vector<std::pair<std::string, NumpyArray<Index>>> groups(const MeshFile& file) {
  std::vector<std::pair<std::string, NumpyArray<Index>>> all;
  for (const Group& group : file.mesh.groups)
    all.emplace_back(group.name, numpy_array(group.vertices, {group.vertices.size()}));
  return all;
}

std::vector<std::tuple<std::string, CellKind, NumpyArray<double>>> cell_fields(const MeshFile& file) {
  std::vector<std::tuple<std::string, CellKind, NumpyArray<double>>> all;
  for (const CellField& field : file.mesh.cell_fields)
    all.emplace_back(field.name, file.mesh.blocks[field.block].kind,
                     numpy_array(field.values, {field.values.size()}));
  return all;
}

nb::bytes image(const MeshFile& file) {
  ArchiveWriter writer;
  writer(file);
  const std::string bytes = writer.take();
  return nb::bytes(bytes.data(), bytes.size());
}

MeshFile from_image(const nb::bytes& image) {
  ArchiveReader reader({image.c_str(), image.size()}, "mesh");
  MeshFile file;
  reader(file);
  reader.end();
  if (!file.mesh.is_whole()) reader.fail();
  return file;
}

std::vector<std::string> texts(const std::vector<MeshIssue>& issues) {
  std::vector<std::string> all;
  for (const MeshIssue& issue : issues) all.push_back(issue.text());
  return all;
}

/// (errors, warnings), one line each.
std::pair<std::vector<std::string>, std::vector<std::string>> check(const MeshFile& file) {
  const MeshReport report = check_mesh_file(file);
  return {texts(report.errors), texts(report.warnings)};
}

MeshFile prepared(const MeshFile& file, int dimension) {
  MeshFile solid = file;
  prepare_solid_mesh(solid, dimension);
  return solid;
}

MeshFile with_corners_only(const MeshFile& file) {
  MeshFile reduced = file;
  use_corners_only(reduced);
  return reduced;
}

MeshFile with_second_order(const MeshFile& file) {
  MeshFile finer = file;
  finer.mesh = second_order(file.mesh).mesh;
  return finer;
}

/// Kinds of cells and the names of the elements with their shape functions, in the order of the catalogue.
std::vector<std::pair<CellKind, std::string>> kinds_with_elements(int dim) {
  std::vector<std::pair<CellKind, std::string>> kinds;
  for (const ElementInfo* element : elements())
    if (element->dim == dim && element_of_cells(cell_kind(*element)) == element)
      kinds.emplace_back(cell_kind(*element), element->name);
  return kinds;
}

/// Weights of the nodes at points, by rows as scipy keeps them: (values, columns, row_begin).
CsrArrays embed(const std::string& element_name, const Array2d<double>& rest_positions,
                const Array2d<Index>& cells, const Array2d<double>& points) {
  const int dim = static_cast<int>(rest_positions.shape(1));
  const ElementInfo& element = require_element(element_name, dim, "element");
  const Embedding embedding(element, {cells.data(), cells.size()}, unknowns(rest_positions), vectors(points));
  Csr csr;
  csr.row_begin = {0};
  std::vector<std::pair<Index, double>> row;
  for (Index p = 0; p < embedding.num_points(); ++p) {
    row.clear();
    for (std::size_t a = 0; a < embedding.nodes(p).size(); ++a)
      row.emplace_back(embedding.nodes(p)[a], embedding.weights(p)[a]);
    std::ranges::sort(row);
    for (const auto& [node, weight] : row) {
      csr.columns.push_back(node);
      csr.values.push_back(weight);
    }
    csr.row_begin.push_back(static_cast<Index>(csr.columns.size()));
  }
  return arrays_of(std::move(csr));
}

}  // namespace

void bind_mesh(nb::module_& module) {
  nb::enum_<CellKind>(module, "CellKind")
      .value("point", CellKind::point)
      .value("line", CellKind::line)
      .value("triangle", CellKind::triangle)
      .value("quadrilateral", CellKind::quadrilateral)
      .value("tetrahedron", CellKind::tetrahedron)
      .value("hexahedron", CellKind::hexahedron)
      .value("prism", CellKind::prism)
      .value("pyramid", CellKind::pyramid)
      .value("line3", CellKind::line3)
      .value("triangle6", CellKind::triangle6)
      .value("tetrahedron10", CellKind::tetrahedron10);
  module.def("num_nodes", &num_nodes, nb::arg("kind"));
  module.def("is_second_order", &is_second_order, nb::arg("kind"));
  nb::enum_<TetPattern>(module, "TetPattern")
      .value("kuhn6", TetPattern::kuhn6)
      .value("five", TetPattern::five);
  nb::enum_<TrianglePattern>(module, "TrianglePattern")
      .value("uniform", TrianglePattern::uniform)
      .value("alternating", TrianglePattern::alternating);

  nb::class_<MeshFile>(module, "Mesh")
      .def_prop_ro("name", [](const MeshFile& file) { return file.numbering.file; })
      .def_ro("warnings", &MeshFile::warnings)
      .def("__getstate__", &image)
      .def("__setstate__",
           [](MeshFile& file, const nb::bytes& bytes) { new (&file) MeshFile(from_image(bytes)); })
      .def("positions", &positions)
      .def("cells", &cells)
      .def("groups", &groups)
      .def("cell_fields", &cell_fields)
      .def("check", &check, nb::call_guard<nb::gil_scoped_release>())
      .def("corners_only", &with_corners_only, nb::call_guard<nb::gil_scoped_release>())
      .def("second_order", &with_second_order, nb::call_guard<nb::gil_scoped_release>())
      .def("prepared", &prepared, nb::arg("dimension"), nb::call_guard<nb::gil_scoped_release>())
      .def(
          "write",
          [](const MeshFile& file, const std::filesystem::path& path) { write_mesh(path, file.mesh); },
          nb::arg("path"), nb::call_guard<nb::gil_scoped_release>());
  module.def("make_mesh", &make_mesh, nb::arg("positions"), nb::arg("cells"), nb::arg("groups"),
             nb::arg("name"));
  module.def("embed", &embed, nb::arg("element"), nb::arg("rest_positions"), nb::arg("cells"),
             nb::arg("points"));
  module.def("read_mesh", &read_mesh, nb::arg("path"), nb::call_guard<nb::gil_scoped_release>());
  module.def(
      "element_cells",
      [](const std::string& element, int dim) { return cell_kind(require_element(element, dim, "element")); },
      nb::arg("element"), nb::arg("dim"));
  module.def("kinds_with_elements", &kinds_with_elements, nb::arg("dim"));
  module.def(
      "make_hexahedron_box",
      [](const std::array<double, 3>& size, const std::array<int, 3>& cubes,
         const std::array<double, 3>& origin) {
        return generated(make_hexahedron_box(Vector3(size.data()), cubes, Vector3(origin.data())), "box");
      },
      nb::arg("size"), nb::arg("cells"), nb::arg("origin"));
  module.def(
      "make_quadrilateral_rectangle",
      [](const std::array<double, 2>& size, const std::array<int, 2>& squares,
         const std::array<double, 2>& origin) {
        return generated(
            make_quadrilateral_rectangle(Vector<2>(size.data()), squares, Vector<2>(origin.data())),
            "rectangle");
      },
      nb::arg("size"), nb::arg("cells"), nb::arg("origin"));
  module.def(
      "make_box",
      [](const std::array<double, 3>& size, const std::array<int, 3>& cubes,
         const std::array<double, 3>& origin, TetPattern pattern) {
        return generated(make_box(Vector3(size.data()), cubes, Vector3(origin.data()), pattern), "box");
      },
      nb::arg("size"), nb::arg("cells"), nb::arg("origin"), nb::arg("pattern"));
  module.def(
      "make_rectangle",
      [](const std::array<double, 2>& size, const std::array<int, 2>& squares,
         const std::array<double, 2>& origin, TrianglePattern pattern) {
        return generated(make_rectangle(Vector<2>(size.data()), squares, Vector<2>(origin.data()), pattern),
                         "rectangle");
      },
      nb::arg("size"), nb::arg("cells"), nb::arg("origin"), nb::arg("pattern"));
}

}  // namespace resilin::python
