#include <array>

#include "resilin/core/error.hpp"
#include "resilin/io/catalog.hpp"
#include "resilin/io/mesh_builder.hpp"
#include "resilin/io/text_scanner.hpp"

// The text format .veg: vertices, elements and sets of elements; materials and regions are passed over.
// Source: Vega FEM library user's manual, "Volumetric mesh file format".

namespace resilin {
namespace {

std::string upper_case(std::string_view text) {
  std::string result(text);
  for (char& c : result) {
    if (c >= 'a' && c <= 'z') c = static_cast<char>(c - 'a' + 'A');
  }
  return result;
}

/// "COUNT PER_ITEM [ATTRIBUTES [MARKERS]]" at the start of a section.
struct Header {
  std::size_t count;
  std::int64_t per_item;
};

Header read_header(TextScanner& text, std::string_view what, std::size_t least_bytes) {
  const std::size_t count = text.count(what, least_bytes);
  const std::int64_t per_item = text.integer("a number per item");
  while (!text.is_line_done()) {
    const std::int64_t extra = text.integer("the number of attributes");
    if (extra != 0) text.fail("0 attributes", std::to_string(extra));
  }
  return {count, per_item};
}

void read_vertices(TextScanner& text, MeshBuilder& mesh) {
  const Header header = read_header(text, "vertices", 8);
  if (header.per_item != 3) text.fail("3 coordinates per vertex", std::to_string(header.per_item));
  for (std::size_t i = 0; i < header.count; ++i) {
    const std::int64_t number = text.integer("a vertex number");
    mesh.add_vertex(number, text.point("a coordinate of vertex " + std::to_string(number)));
  }
  mesh.finish_vertices();
}

void read_elements(TextScanner& text, MeshBuilder& mesh) {
  const std::string type = upper_case(text.word("an element type"));
  const bool is_tet = type == "TET" || type == "TETS";
  if (!is_tet && type != "CUBIC") text.fail("the element type TET or CUBIC", type);
  const CellKind kind = is_tet ? CellKind::tetrahedron : CellKind::hexahedron;
  const Header header = read_header(text, "elements", 10);
  if (header.per_item != num_nodes(kind)) {
    text.fail(std::to_string(num_nodes(kind)) + " vertices per element", std::to_string(header.per_item));
  }
  std::array<Index, max_cell_nodes> nodes{};
  const auto size = static_cast<std::size_t>(num_nodes(kind));
  for (std::size_t i = 0; i < header.count; ++i) {
    const std::int64_t element = text.integer("an element number");
    const std::string what = "a vertex number of element " + std::to_string(element);
    for (std::size_t n = 0; n < size; ++n) nodes[n] = mesh.vertex(text.integer(what), element);
    mesh.add_cell(kind, element, std::span(nodes).first(size));
  }
}

/// "NAME" and then element numbers, separated by commas and white space, up to the next section.
void read_set(TextScanner& text, MeshBuilder& mesh) {
  const std::size_t group = mesh.group(std::string(text.word("the name of a set")));
  while (!text.at_end() && text.peek()[0] != '*') {
    std::string_view words = text.word("an element number");
    while (!words.empty()) {
      const std::size_t comma = words.find(',');
      const std::string_view number_text = words.substr(0, comma);
      words.remove_prefix(comma == words.npos ? words.size() : comma + 1);
      if (number_text.empty()) continue;
      std::int64_t number = 0;
      MeshBuilder::Cell cell{};
      if (!parse_integer(number_text, number) || !mesh.find_cell(number, cell)) {
        text.fail("the number of an element that *ELEMENTS gives", number_text);
      }
      mesh.add_to_group(group, cell);
    }
  }
}

}  // namespace

MeshFile read_vega(const MeshSource& source) {
  TextScanner text(source.name, source.bytes, '#');
  MeshBuilder mesh(source.name, "Vega");
  bool has_vertices = false;
  bool has_elements = false;
  while (!text.at_end()) {
    const std::string section = upper_case(text.word("a section"));
    if (section[0] != '*') text.fail("a section such as *VERTICES", section);
    text.set_section(printable(section));
    if (section == "*VERTICES" || section == "*ELEMENTS") {
      bool& is_known = section == "*VERTICES" ? has_vertices : has_elements;
      if (is_known) text.fail("one section " + section, "a second one");
      is_known = true;
      section == "*VERTICES" ? read_vertices(text, mesh) : read_elements(text, mesh);
    } else if (section == "*SET") {
      read_set(text, mesh);
    } else if (section == "*INCLUDE") {
      text.fail("all of the mesh in one file", "*INCLUDE", "copy the included file into this one");
    } else {  // *MATERIAL, *REGION
      while (!text.at_end() && text.peek()[0] != '*') text.word("");
    }
  }
  return mesh.finish();
}

}  // namespace resilin
