#include <algorithm>
#include <string>
#include <vector>

#include "resilin/core/error.hpp"
#include "resilin/io/binary_value.hpp"
#include "resilin/io/catalog.hpp"
#include "resilin/io/mesh_builder.hpp"
#include "resilin/io/place_index.hpp"
#include "resilin/io/text_scanner.hpp"

// STL surfaces, ASCII and binary. Each triangle brings its corners; those at exactly the same place become
// one vertex. Normals and attributes are passed over. Source: 3D Systems, "StereoLithography Interface
// Specification", 1988.

namespace resilin {
namespace {

constexpr std::size_t header_size = 80;
constexpr std::size_t count_size = 4;
constexpr std::size_t triangle_size = 50;  // normal, three corners, two bytes of attributes
constexpr std::size_t number_size = 4;

std::size_t num_promised(std::string_view bytes) {
  if (bytes.size() < header_size + count_size) return 0;
  return static_cast<std::size_t>(
      decoded(bytes.substr(header_size, count_size), binary_uint32, std::endian::little));
}

std::size_t binary_size(std::size_t num_triangles) {
  return header_size + count_size + triangle_size * num_triangles;
}

/// Binary files may begin with "solid" too: what counts is that their size is the one that they promise, else
/// that a facet or the end follows the name.
bool is_text(std::string_view bytes) {
  if (bytes.size() >= header_size + count_size && bytes.size() == binary_size(num_promised(bytes)))
    return false;
  TextScanner text("", bytes);
  if (lower_case(text.peek()) != "solid") return false;
  text.rest_of_line();
  const std::string next = lower_case(text.peek());
  return next.empty() || next == "facet" || next == "endsolid";
}

class StlReader {
 public:
  explicit StlReader(const MeshSource& source)
      : source_(source), text_(source.name, source.bytes), mesh_(source.name, "STL", "triangle") {}

  MeshFile read() {
    if (is_text(source_.bytes)) {
      while (!text_.at_end()) read_solid();
    } else {
      read_binary();
    }
    if (corners_.empty()) throw InputError(source_.name, "no triangles");
    mesh_.finish_vertices();
    add_triangles();
    return mesh_.finish();
  }

 private:
  void expect(std::string_view keyword) {
    const std::string_view word = text_.word(keyword);
    if (lower_case(word) != keyword) text_.fail(keyword, word);
  }

  void read_solid() {
    text_.set_section("a solid");
    expect("solid");
    const std::string name = text_.is_line_done() ? "" : std::string(text_.rest_of_line());
    const std::size_t first = num_triangles();
    while (true) {
      const std::string_view word = text_.word("facet or endsolid");
      const std::string keyword = lower_case(word);
      if (keyword == "endsolid") break;
      if (keyword != "facet") text_.fail("facet or endsolid", word);
      read_facet();
    }
    text_.rest_of_line();  // the name again
    if (!name.empty() && num_triangles() > first) solids_.push_back({name, first, num_triangles()});
  }

  void read_facet() {
    expect("normal");
    for (int i = 0; i < 3; ++i) text_.word("a component of a normal");
    expect("outer");
    expect("loop");
    for (int i = 0; i < 3; ++i) {
      expect("vertex");
      add_corner(text_.point("a coordinate of triangle " + std::to_string(num_triangles() + 1)));
    }
    expect("endloop");
    expect("endfacet");
  }

  void read_binary() {
    const std::string_view bytes = source_.bytes;
    const std::size_t count = num_promised(bytes);
    if (bytes.size() < header_size + count_size) {
      throw InputError(
          source_.name,
          "\"solid\" or a binary header of " + std::to_string(header_size + count_size) + " bytes",
          std::to_string(bytes.size()) + " bytes", "the file is cut, or it is no STL");
    }
    if (bytes.size() < binary_size(count)) {
      throw InputError(source_.name,
                       std::to_string(binary_size(count)) + " bytes for the " + std::to_string(count) +
                           " triangles that the header promises",
                       std::to_string(bytes.size()), "the file is cut, or it is no STL");
    }
    for (std::size_t t = 0; t < count; ++t)
      for (std::size_t corner = 0; corner < 3; ++corner) {
        const std::size_t begin =
            header_size + count_size + t * triangle_size + 3 * number_size * (corner + 1);
        add_corner(binary_place(bytes.substr(begin, 3 * number_size), t));
      }
    if (bytes.size() > binary_size(count))
      mesh_.warn(std::to_string(bytes.size() - binary_size(count)) +
                 " bytes behind the last triangle are skipped");
  }

  Vector3 binary_place(std::string_view bytes, std::size_t triangle) const {
    Vector3 place;
    for (int i = 0; i < 3; ++i)
      place[i] = decoded(bytes.substr(number_size * static_cast<std::size_t>(i), number_size), binary_float32,
                         std::endian::little);
    if (!place.allFinite())
      throw InputError(mesh_.cell_place(static_cast<std::int64_t>(triangle) + 1), "finite coordinates",
                       "inf or nan");
    return place;
  }

  void add_corner(const Vector3& place) {
    const auto known = static_cast<Index>(vertices_.size());
    corners_.push_back(vertices_.number_of(place));
    if (corners_.back() == known) mesh_.add_vertex(known + 1, vertices_.places().back());
  }

  std::size_t num_triangles() const { return corners_.size() / 3; }

  void add_triangles() {
    std::vector<MeshBuilder::Cell> cells;
    for (std::size_t t = 0; t < num_triangles(); ++t)
      cells.push_back(mesh_.add_cell(CellKind::triangle, static_cast<std::int64_t>(t) + 1,
                                     std::span(corners_).subspan(3 * t, 3)));
    for (const Solid& solid : solids_) {
      const std::size_t group = mesh_.group(solid.name);
      for (std::size_t t = solid.first; t < solid.last; ++t) mesh_.add_to_group(group, cells[t]);
    }
  }

  /// A named part of an ASCII file.
  struct Solid {
    std::string name;
    std::size_t first, last;  ///< triangles
  };

  const MeshSource& source_;
  TextScanner text_;
  MeshBuilder mesh_;
  PlaceIndex vertices_;
  std::vector<Index> corners_;  ///< three for each triangle
  std::vector<Solid> solids_;
};

}  // namespace

MeshFile read_stl(const MeshSource& source) { return StlReader(source).read(); }

}  // namespace resilin
