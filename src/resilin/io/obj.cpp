#include <algorithm>
#include <array>
#include <ostream>

#include "resilin/core/error.hpp"
#include "resilin/core/text.hpp"
#include "resilin/io/catalog.hpp"
#include "resilin/io/mesh_builder.hpp"
#include "resilin/io/text_scanner.hpp"
#include "resilin/mesh/edit.hpp"

// Wavefront OBJ surfaces: positions and polygons; texture coordinates, normals and materials are passed over.
// Source: Wavefront Technologies, "Advanced Visualizer Manual", appendix B1.

namespace resilin {
namespace {

/// A triangle as the file gives it: vertices may still follow, so it is checked at the end.
struct Triangle {
  std::array<std::int64_t, 3> vertices;  ///< from 1
  std::int64_t face;
  std::int64_t line;
  std::size_t groups;  ///< which list of groups it belongs to
};

class ObjReader {
 public:
  explicit ObjReader(const MeshSource& source)
      : text_(source.name, source.bytes, '#'), mesh_(source.name, "OBJ", "face") {}

  MeshFile read() {
    while (!text_.at_end()) read_statement();
    mesh_.finish_vertices();
    for (const Triangle& triangle : triangles_) add(triangle);
    return mesh_.finish();
  }

 private:
  void read_statement() {
    const std::string_view keyword = text_.word("a statement");
    if (keyword == "v") {
      read_vertex();
    } else if (keyword == "f") {
      read_face();
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

  void read_face() {
    std::vector<std::int64_t> corners;
    while (!text_.is_line_done()) {
      const std::string_view reference = text_.word("a vertex number");
      if (reference == "\\") {
        text_.skip_line_end();  // the statement goes on in the next line
      } else {
        corners.push_back(vertex_number(reference));
      }
    }
    if (corners.size() < 3) {
      text_.fail("at least 3 vertices of a face", std::to_string(corners.size()), "the file may be cut");
    }
    ++num_faces_;
    for (std::size_t i = 2; i < corners.size(); ++i) {
      triangles_.push_back(
          {{corners[0], corners[i - 1], corners[i]}, num_faces_, text_.line(), group_lists_.size() - 1});
    }
  }

  void read_groups() {
    std::vector<std::size_t> groups;
    while (!text_.is_line_done()) groups.push_back(mesh_.group(std::string(text_.word("a group name"))));
    group_lists_.push_back(std::move(groups));
  }

  void add(const Triangle& triangle) {
    std::array<Index, 3> nodes{};
    for (std::size_t i = 0; i < 3; ++i) {
      nodes[i] = mesh_.find_vertex(triangle.vertices[i]);
      if (nodes[i] < 0) {
        throw InputError(text_.file() + ": line " + std::to_string(triangle.line),
                         "a vertex number from 1 to " + std::to_string(num_vertices_),
                         std::to_string(triangle.vertices[i]));
      }
    }
    const auto cell = mesh_.add_cell(CellKind::triangle, triangle.face, nodes);
    for (const std::size_t group : group_lists_[triangle.groups]) mesh_.add_to_group(group, cell);
  }

  TextScanner text_;
  MeshBuilder mesh_;
  std::int64_t num_vertices_ = 0;
  std::int64_t num_faces_ = 0;
  std::vector<Triangle> triangles_;
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
