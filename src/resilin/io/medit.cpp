#include <algorithm>
#include <array>
#include <ostream>

#include "resilin/core/error.hpp"
#include "resilin/core/text.hpp"
#include "resilin/io/catalog.hpp"
#include "resilin/io/mesh_builder.hpp"
#include "resilin/io/text_scanner.hpp"

// The ASCII .mesh format of Medit. Source: P. Frey, "Medit: an interactive mesh visualization software",
// INRIA technical report RT-0253, 2001.

namespace resilin {
namespace {

struct Keyword {
  std::string_view word;
  CellKind kind;
};

constexpr std::array<Keyword, 11> cell_keywords = {{{"Edges", CellKind::line},
                                                    {"Triangles", CellKind::triangle},
                                                    {"Quadrilaterals", CellKind::quadrilateral},
                                                    {"Tetrahedra", CellKind::tetrahedron},
                                                    {"Tetrahedrons", CellKind::tetrahedron},
                                                    {"Hexahedra", CellKind::hexahedron},
                                                    {"Hexaedra", CellKind::hexahedron},
                                                    {"Prisms", CellKind::prism},
                                                    {"Pyramids", CellKind::pyramid},
                                                    {"EdgesP2", CellKind::line3},
                                                    {"TrianglesP2", CellKind::triangle6}}};

bool is_word(std::string_view text) {
  return !text.empty() && ((text[0] >= 'A' && text[0] <= 'Z') || (text[0] >= 'a' && text[0] <= 'z'));
}

void read_vertices(TextScanner& text, MeshBuilder& mesh, int dim) {
  const std::size_t count = text.count("vertices", static_cast<std::size_t>(2 * dim + 2));
  std::vector<std::pair<Index, std::int64_t>> references;
  for (std::size_t i = 0; i < count; ++i) {
    const auto number = static_cast<std::int64_t>(i + 1);
    mesh.add_vertex(number, text.point("a coordinate of vertex " + std::to_string(number), dim));
    const std::int64_t reference = text.integer("the reference of vertex " + std::to_string(number));
    if (reference != 0) references.emplace_back(static_cast<Index>(i), reference);
  }
  mesh.finish_vertices();
  for (const auto& [vertex, reference] : references) {
    mesh.add_vertex_to_group(mesh.group(numbered_group_name(0, reference)), vertex);
  }
}

void read_cells(TextScanner& text, MeshBuilder& mesh, CellKind kind) {
  const auto size = static_cast<std::size_t>(num_nodes(kind));
  const std::size_t count = text.count(name(kind), 2 * size + 2);
  std::array<Index, max_cell_nodes> nodes{};
  for (std::size_t i = 0; i < count; ++i) {
    const auto number = static_cast<std::int64_t>(i + 1);
    const std::string what =
        "a vertex of element " + std::to_string(number) + " of " + std::string(name(kind));
    for (std::size_t n = 0; n < size; ++n) nodes[n] = mesh.vertex(text.integer(what), number);
    const auto cell = mesh.add_cell(kind, number, std::span(nodes).first(size));
    const std::int64_t reference = text.integer("the reference after element " + std::to_string(number));
    if (reference != 0) mesh.add_to_group(mesh.group(numbered_group_name(dimension(kind), reference)), cell);
  }
}

}  // namespace

MeshFile read_medit(const MeshSource& source) {
  TextScanner text(source.name, source.bytes, '#');
  if (text.peek() != "MeshVersionFormatted") {
    text.fail("\"MeshVersionFormatted\" at the start of a Medit file",
              text.at_end() ? "the end of the file" : text.peek());
  }
  text.word("");
  const std::int64_t version = text.integer("a format version");
  if (version < 1 || version > 4) text.fail("format version 1 to 4", "version " + std::to_string(version));
  MeshBuilder mesh(source.name, "Medit");
  int dim = 3;
  bool has_vertices = false;
  bool has_end = false;
  while (!has_end && !text.at_end()) {
    const std::string keyword(text.word("a keyword"));
    if (!is_word(keyword)) text.fail("a keyword such as Vertices", keyword);
    text.set_section(keyword);
    const auto found = std::find_if(cell_keywords.begin(), cell_keywords.end(),
                                    [&](const Keyword& k) { return k.word == keyword; });
    if (keyword == "End") {
      has_end = true;
    } else if (keyword == "Dimension") {
      const std::int64_t given = text.integer("a dimension");
      if (given != 2 && given != 3) text.fail("dimension 2 or 3", std::to_string(given));
      dim = static_cast<int>(given);
    } else if (keyword == "Vertices") {
      if (has_vertices) text.fail("one section Vertices", "a second one");
      has_vertices = true;
      read_vertices(text, mesh, dim);
    } else if (found != cell_keywords.end()) {
      read_cells(text, mesh, found->kind);
    } else {  // Corners, Ridges, Normals, ...: numbers up to the next keyword
      while (!text.at_end() && !is_word(text.peek())) text.word("");
    }
  }
  if (!has_end) mesh.warn("no \"End\" at the end; the file may be cut");
  return mesh.finish();
}

void write_medit(std::ostream& stream, const Mesh& mesh) {
  stream << "MeshVersionFormatted 2\nDimension 3\n";
  stream << "Vertices\n" << mesh.vertices.size() << '\n';
  std::string line;
  for (const Vector3& X : mesh.vertices) {
    line = format_number(X.x()) + ' ' + format_number(X.y()) + ' ' + format_number(X.z()) + " 0\n";
    stream << line;
  }
  for (std::size_t b = 0; b < mesh.blocks.size(); ++b) {
    const CellBlock& block = mesh.blocks[b];
    const auto found = std::find_if(cell_keywords.begin(), cell_keywords.end(),
                                    [&](const Keyword& k) { return k.kind == block.kind; });
    if (found == cell_keywords.end()) {
      throw InputError("Medit file",
                       "has no place for " + std::string(name(block.kind)) + "; write .msh or .vtu");
    }
    // A cell bears one reference: that of the last group that has it.
    std::vector<std::size_t> references(static_cast<std::size_t>(block.num_cells()), 0);
    for (std::size_t g = 0; g < mesh.groups.size(); ++g) {
      if (b >= mesh.groups[g].cells.size()) continue;
      for (const Index cell : mesh.groups[g].cells[b]) references[static_cast<std::size_t>(cell)] = g + 1;
    }
    stream << found->word << '\n' << block.num_cells() << '\n';
    for (Index cell = 0; cell < block.num_cells(); ++cell) {
      for (const Index node : block.cell(cell)) stream << node + 1 << ' ';
      stream << references[static_cast<std::size_t>(cell)] << '\n';
    }
  }
  stream << "End\n";
}

}  // namespace resilin
