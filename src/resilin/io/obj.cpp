#include <algorithm>
#include <array>
#include <ostream>
#include <span>

#include "resilin/core/error.hpp"
#include "resilin/core/text.hpp"
#include "resilin/io/catalog.hpp"
#include "resilin/io/mesh_builder.hpp"
#include "resilin/io/text_scanner.hpp"
#include "resilin/mesh/edit.hpp"

// Wavefront OBJ surfaces: positions, polygons, lines and points; texture coordinates, normals and materials
// are passed over.
// Source: Wavefront Technologies, "Advanced Visualizer Manual", appendix B1.

namespace resilin {
namespace {

/// A part as the file gives it: vertices may still follow, so it is checked at the end.
struct Part {
  CellKind kind;                         ///< triangle, line or point
  std::array<std::int64_t, 3> vertices;  ///< from 1, as many as the kind has
  std::int64_t face;
  std::int64_t line;
  std::size_t groups;  ///< number of its list of groups
};

class ObjReader {
 public:
  explicit ObjReader(const MeshSource& source)
      : text_(source.name, source.bytes, '#'), mesh_(source.name, "OBJ", "face") {}

  MeshFile read() {
    while (!text_.at_end()) read_statement();
    mesh_.finish_vertices();
    for (const Part& part : parts_) add(part);
    return mesh_.finish();
  }

 private:
  void read_statement() {
    const std::string_view keyword = text_.word("a statement");
    if (keyword == "v") {
      read_vertex();
    } else if (keyword == "f") {
      read_face();
    } else if (keyword == "l") {
      read_line();
    } else if (keyword == "p") {
      read_points();
    } else if (keyword == "g" || keyword == "o") {
      read_groups();
    } else if (is_statement(keyword)) {
      text_.rest_of_line();  // vt, vn, usemtl, s, ...
    } else {
      text_.fail("an OBJ statement such as v or f", keyword);
    }
  }

  static bool is_statement(std::string_view keyword) {
    return std::all_of(keyword.begin(), keyword.end(),
                       [](char c) { return (c >= 'a' && c <= 'z') || c == '_'; });
  }

  void read_vertex() {
    Vector3 position;
    for (int i = 0; i < 3; ++i) {
      if (text_.is_line_done()) text_.fail("3 coordinates of a vertex", std::to_string(i));
      position[i] = text_.real("a coordinate of vertex " + std::to_string(num_vertices_ + 1));
    }
    text_.rest_of_line();  // a weight or a colour may follow
    mesh_.add_vertex(++num_vertices_, position);
  }

  /// "7", "7/1", "7//3" or "7/1/3"; a negative number counts back from the vertex read last.
  std::int64_t vertex_number(std::string_view reference) {
    std::int64_t number = 0;
    if (!parse_integer(reference.substr(0, reference.find('/')), number) || number == 0) {
      text_.fail("a vertex number from 1 to " + std::to_string(num_vertices_), reference);
    }
    if (number < 0 && number >= -num_vertices_) return num_vertices_ + number + 1;
    if (number < 0)
      text_.fail("a vertex number from -" + std::to_string(num_vertices_) + " to -1", reference);
    return number;
  }

  std::vector<std::int64_t> read_corners(std::size_t least, const std::string& of_what) {
    std::vector<std::int64_t> corners;
    while (!text_.is_line_done()) {
      const std::string_view reference = text_.word("a vertex number");
      if (reference == "\\") {
        text_.skip_line_end();  // the statement goes on in the next line
      } else {
        corners.push_back(vertex_number(reference));
      }
    }
    if (corners.size() < least) {
      text_.fail(
          "at least " + std::to_string(least) + (least == 1 ? " vertex" : " vertices") + " of " + of_what,
          std::to_string(corners.size()), "the file may be cut");
    }
    ++num_faces_;
    return corners;
  }
  void push(CellKind kind, const std::array<std::int64_t, 3>& vertices) {
    parts_.push_back({kind, vertices, num_faces_, text_.line(), group_lists_.size() - 1});
  }

  void read_face() {
    const std::vector<std::int64_t> corners = read_corners(3, "a face");
    for (std::size_t i = 2; i < corners.size(); ++i)
      push(CellKind::triangle, {corners[0], corners[i - 1], corners[i]});
  }
  void read_line() {
    const std::vector<std::int64_t> corners = read_corners(2, "a line");
    for (std::size_t i = 1; i < corners.size(); ++i) push(CellKind::line, {corners[i - 1], corners[i]});
  }
  void read_points() {
    for (const std::int64_t vertex : read_corners(1, "points")) push(CellKind::point, {vertex});
  }

  void read_groups() {
    std::vector<std::size_t> groups;
    while (!text_.is_line_done()) groups.push_back(mesh_.group(std::string(text_.word("a group name"))));
    group_lists_.push_back(std::move(groups));
  }

  void add(const Part& part) {
    std::array<Index, 3> nodes{};
    const auto count = static_cast<std::size_t>(num_nodes(part.kind));
    for (std::size_t i = 0; i < count; ++i) {
      nodes[i] = mesh_.find_vertex(part.vertices[i]);
      if (nodes[i] < 0) {
        throw InputError(text_.file() + ": line " + std::to_string(part.line),
                         "a vertex number from 1 to " + std::to_string(num_vertices_),
                         std::to_string(part.vertices[i]));
      }
    }
    const auto cell = mesh_.add_cell(part.kind, part.face, std::span(nodes).first(count));
    for (const std::size_t group : group_lists_[part.groups]) mesh_.add_to_group(group, cell);
  }

  TextScanner text_;
  MeshBuilder mesh_;
  std::int64_t num_vertices_ = 0;
  std::int64_t num_faces_ = 0;
  std::vector<Part> parts_;
  std::vector<std::vector<std::size_t>> group_lists_ = {{}};
};

}  // namespace

MeshFile read_obj(const MeshSource& source) { return ObjReader(source).read(); }

void write_obj(std::ostream& stream, const Mesh& mesh) {
  const Mesh surface = extract_surface(mesh).mesh;
  for (const Vector3& X : surface.vertices) {
    stream << "v " << format_number(X.x()) << ' ' << format_number(X.y()) << ' ' << format_number(X.z())
           << '\n';
  }
  const CellBlock& triangles = surface.blocks[0];
  for (Index t = 0; t < triangles.num_cells(); ++t) {
    const auto nodes = triangles.cell(t);
    stream << "f " << nodes[0] + 1 << ' ' << nodes[1] + 1 << ' ' << nodes[2] + 1 << '\n';
  }
}

}  // namespace resilin
