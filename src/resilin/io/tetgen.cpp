#include <array>
#include <cmath>
#include <filesystem>

#include "resilin/core/error.hpp"
#include "resilin/core/text.hpp"
#include "resilin/io/catalog.hpp"
#include "resilin/io/mesh_builder.hpp"
#include "resilin/io/text_scanner.hpp"

// A mesh of TetGen (or, in 2D, Triangle) in two files: NAME.node and NAME.ele. Either may be given. Numbers
// count from 0 or 1. Source: H. Si, TetGen user's manual 1.5, section 5.2.

namespace resilin {
namespace {

/// Attribute or marker that is a whole number other than 0, as the number of a group; else 0.
std::int64_t group_number(double value) {
  return std::nearbyint(value) == value && std::abs(value) < 1e15 ? static_cast<std::int64_t>(value) : 0;
}

/// The next number of a header line, 0 when the line has no more.
std::int64_t optional_integer(TextScanner& text, std::string_view what) {
  return text.is_line_done() ? 0 : text.integer(what);
}

int read_nodes(TextScanner& text, MeshBuilder& mesh) {
  const std::size_t count = text.count("nodes", 6);
  const std::int64_t dim = text.integer("the dimension");
  if (dim != 2 && dim != 3) text.fail("the dimension 2 or 3", std::to_string(dim));
  const std::size_t num_attributes =
      text.checked_count(optional_integer(text, "the number of attributes"), "attributes", 2);
  const std::int64_t num_markers = optional_integer(text, "the number of markers");
  if (num_markers != 0 && num_markers != 1) text.fail("0 or 1 boundary markers", std::to_string(num_markers));
  std::vector<std::pair<Index, std::int64_t>> marked;
  for (std::size_t i = 0; i < count; ++i) {
    const std::int64_t number = text.integer("a node number");
    mesh.add_vertex(number,
                    text.point("a coordinate of node " + std::to_string(number), static_cast<int>(dim)));
    for (std::size_t a = 0; a < num_attributes; ++a)
      text.real("an attribute of node " + std::to_string(number));
    if (num_markers == 0) continue;
    const std::int64_t marker = text.integer("the marker of node " + std::to_string(number));
    if (marker != 0) marked.emplace_back(static_cast<Index>(i), marker);
  }
  mesh.finish_vertices();
  for (const auto& [vertex, marker] : marked) {
    mesh.add_vertex_to_group(mesh.group(numbered_group_name(0, marker)), vertex);
  }
  return static_cast<int>(dim);
}

void read_elements(TextScanner& text, MeshBuilder& mesh, int dim) {
  const CellKind kind = dim == 3 ? CellKind::tetrahedron : CellKind::triangle;
  const auto size = static_cast<std::size_t>(num_nodes(kind));
  const std::size_t count = text.count("elements", 2 * size + 2);
  const std::int64_t nodes_each = text.integer("the number of nodes of an element");
  if (nodes_each != num_nodes(kind)) {
    text.fail(std::to_string(num_nodes(kind)) + " nodes for each of the " + std::string(name(kind)),
              std::to_string(nodes_each), "second-order elements (-o2) are not read");
  }
  const std::size_t num_attributes =
      text.checked_count(optional_integer(text, "the number of attributes"), "attributes", 2);
  std::array<Index, 4> nodes{};
  for (std::size_t i = 0; i < count; ++i) {
    const std::int64_t element = text.integer("an element number");
    const std::string what = "a node number of element " + std::to_string(element);
    for (std::size_t n = 0; n < size; ++n) nodes[n] = mesh.vertex(text.integer(what), element);
    const auto cell = mesh.add_cell(kind, element, std::span(nodes).first(size));
    for (std::size_t a = 0; a < num_attributes; ++a) {
      const std::int64_t region =
          group_number(text.real("an attribute of element " + std::to_string(element)));
      if (a == 0 && region != 0) mesh.add_to_group(mesh.group(numbered_group_name(dim, region)), cell);
    }
  }
}

}  // namespace

MeshFile read_tetgen(const MeshSource& source) {
  const bool is_node_file = source.extension() == "node";
  if (!source.companion) {
    throw InputError(source.name, "a TetGen mesh as two files (.node and .ele)", "only one of them");
  }
  const std::string other_extension = is_node_file ? "ele" : "node";
  const std::string other_bytes = source.companion(source.name_beside(other_extension));
  const std::string other_name =
      std::filesystem::path(source.name).replace_extension(other_extension).string();
  TextScanner own(source.name, source.bytes, '#');
  TextScanner other(other_name, without_byte_order_mark(other_bytes, other_name), '#');
  TextScanner& nodes = is_node_file ? own : other;
  TextScanner& elements = is_node_file ? other : own;
  nodes.set_section("the nodes");
  elements.set_section("the elements");

  MeshBuilder mesh(elements.file(), "TetGen");
  const int dim = read_nodes(nodes, mesh);
  read_elements(elements, mesh, dim);
  return mesh.finish();
}

}  // namespace resilin
