#include <array>
#include <string>
#include <vector>

#include "resilin/core/error.hpp"
#include "resilin/io/catalog.hpp"
#include "resilin/io/mesh_builder.hpp"
#include "resilin/io/text_scanner.hpp"

// OFF surfaces in text: vertices and polygons; normals, colours and texture coordinates are passed over.
// Source: Geomview manual, "OFF Files".

namespace resilin {
namespace {

constexpr std::string_view off_cure = "save it as OFF in text, with three coordinates a vertex";

/// Whether the first word is one of OFF, COFF, NOFF, STOFF and their mixtures.
bool is_off_word(std::string_view word) {
  for (const std::string_view prefix : {"ST", "C", "N"})
    if (word.starts_with(prefix)) word.remove_prefix(prefix.size());
  return word == "OFF";
}

void read_off_header(TextScanner& text) {
  const std::string_view word = text.peek();
  std::int64_t number = 0;
  if (parse_integer(word, number)) return;  // the word is optional
  if (!is_off_word(word)) text.fail("OFF", text.word("OFF"), std::string(off_cure));
  text.word("");
  if (text.peek() == "BINARY") text.fail("OFF in text", "BINARY", std::string(off_cure));
}

}  // namespace

MeshFile read_off(const MeshSource& source) {
  TextScanner text(source.name, source.bytes, '#');
  MeshBuilder mesh(source.name, "OFF", "face");
  read_off_header(text);
  text.set_section("the vertices");
  const std::size_t num_vertices = text.count("vertices", 6), num_faces = text.count("faces", 2);
  text.rest_of_line();  // the number of edges, which nobody keeps right
  for (std::size_t i = 0; i < num_vertices; ++i) {
    mesh.add_vertex(static_cast<std::int64_t>(i), text.point("a coordinate of vertex " + std::to_string(i)));
    text.rest_of_line();
  }
  mesh.finish_vertices();
  text.set_section("the faces");
  std::vector<std::int64_t> corners;
  for (std::size_t i = 0; i < num_faces; ++i) {
    const auto number = static_cast<std::int64_t>(i);
    const std::string what = "a vertex of face " + std::to_string(i);
    corners.resize(text.count("vertices of face " + std::to_string(i), 2));
    for (std::int64_t& corner : corners) corner = text.integer(what);
    text.rest_of_line();                                    // a colour
    mesh.add_polygon(number, corners, /*is_strip=*/false);  // points and lines give no triangle
  }
  return mesh.finish();
}

}  // namespace resilin
