#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

#include "resilin/core/error.hpp"
#include "resilin/io/binary_value.hpp"
#include "resilin/io/catalog.hpp"
#include "resilin/io/mesh_builder.hpp"
#include "resilin/io/text_scanner.hpp"
#include "resilin/io/vtu.hpp"

// Legacy VTK files with an unstructured grid, a structured one or a surface (POLYDATA), ASCII and binary (big
// endian), versions 1 to 5.1. Source: Kitware, "VTK file formats", simple legacy formats.

namespace resilin {
namespace {

class VtkReader {
 public:
  explicit VtkReader(const MeshSource& source)
      : text_(source.name, source.bytes), mesh_(source.name, "VTK", "cell") {}

  MeshFile read() {
    read_header();
    std::string section = "the header";
    while (!text_.at_end()) {
      const std::string keyword(text_.word("a keyword"));
      double number = 0;
      if (parse_real(keyword, number))
        text_.fail("a keyword after the entries of " + section, keyword,
                   section + " has more entries than its first line says");
      section = printable(keyword);
      text_.set_section(section);
      read_part(keyword);
    }
    if (!has_points_) throw InputError(text_.file(), "no POINTS");
    if (has_cells_ && !has_types_ && dataset_ == Dataset::unstructured)
      throw InputError(text_.file(), "no CELL_TYPES for the CELLS; the file may be cut");
    if (dataset_ == Dataset::surface && pieces_.empty())
      throw InputError(text_.file(), "polygons", "none", "points and lines alone are no surface");
    MeshFile file = mesh_.finish();
    file.is_surface = dataset_ == Dataset::surface;
    return file;
  }

 private:
  void read_header() {
    const std::string_view first = text_.rest_of_line();
    constexpr std::string_view start = "# vtk DataFile Version ";
    double version = 0;
    if (!first.starts_with(start) || !parse_real(first.substr(start.size()), version)) {
      throw InputError(text_.file() + ": line 1", "\"# vtk DataFile Version 3.0\"", printable(first));
    }
    if (!(version >= 1 && version < 6)) {
      throw InputError(text_.file() + ": line 1", "version 1.0 to 5.1",
                       "version " + printable(first.substr(start.size())));
    }
    text_.rest_of_line();  // the title
    const std::string_view encoding = text_.word("ASCII or BINARY");
    if (encoding != "ASCII" && encoding != "BINARY") text_.fail("ASCII or BINARY", encoding);
    is_binary_ = encoding == "BINARY";
    if (text_.word("DATASET") != "DATASET") text_.fail("DATASET", "another keyword");
    const std::string_view dataset = text_.word("a dataset");
    if (dataset == "POLYDATA") {
      dataset_ = Dataset::surface;
    } else if (dataset == "STRUCTURED_GRID") {
      dataset_ = Dataset::structured;
    } else if (dataset != "UNSTRUCTURED_GRID") {
      text_.fail("DATASET UNSTRUCTURED_GRID, STRUCTURED_GRID or POLYDATA", dataset,
                 "ParaView makes cells of an image: Threshold, then Save Data");
    }
  }

  void read_part(const std::string& keyword) {
    if (keyword == "POINTS") {
      read_points();
    } else if (keyword == "DIMENSIONS" && dataset_ == Dataset::structured) {
      read_dimensions();
    } else if (keyword == "CELLS") {
      if (has_cells_) text_.fail("one section CELLS", "a second one");
      has_cells_ = true;
      cells_ = read_lists(keyword);
    } else if (dataset_ == Dataset::surface && (keyword == "VERTICES" || keyword == "LINES")) {
      num_cells_ += read_lists(keyword).ranges.size();  // counted for the values of cells
    } else if (dataset_ == Dataset::surface && (keyword == "POLYGONS" || keyword == "TRIANGLE_STRIPS")) {
      add_polygons(read_lists(keyword), keyword);
    } else if (keyword == "CELL_TYPES") {
      read_cell_types();
    } else if (keyword == "POINT_DATA" || keyword == "CELL_DATA") {
      is_cell_data_ = keyword == "CELL_DATA";
      num_data_ = text_.count("values", 1);
    } else if (keyword == "SCALARS") {
      read_scalars();
    } else if (keyword == "VECTORS" || keyword == "NORMALS" || keyword == "TENSORS") {
      text_.word("a name");
      read_reals(type(), num_data_ * (keyword == "TENSORS" ? 9 : 3));
    } else if (keyword == "TEXTURE_COORDINATES") {
      text_.word("a name");
      const std::size_t components = text_.count("components", 1);
      read_reals(type(), num_data_ * components);
    } else if (keyword == "COLOR_SCALARS") {
      text_.word("a name");
      read_reals(colour_, num_data_ * text_.count("components", 1));
    } else if (keyword == "LOOKUP_TABLE") {
      text_.word("a name");
      read_reals(colour_, 4 * text_.count("colours", 1));
    } else if (keyword == "FIELD") {
      read_field();
    } else if (keyword == "METADATA") {
      text_.rest_of_line();
      while (text_.remaining() > 0 && !text_.rest_of_line().empty()) {
      }
    } else {
      text_.fail(dataset_ == Dataset::surface ? "POINTS, POLYGONS, CELL_DATA, SCALARS, ..."
                                              : "POINTS, CELLS, CELL_TYPES, CELL_DATA, SCALARS, ...",
                 keyword);
    }
  }

  BinaryType type() {
    const std::string_view name = text_.word("a data type");
    if (name == "double") return {8, true, true};
    if (name == "float") return {4, true, true};
    if (name == "vtktypeint64" || name == "long" || name == "vtkIdType") return {8, false, true};
    if (name == "vtktypeuint64" || name == "unsigned_long") return {8, false, false};
    if (name == "int" || name == "vtktypeint32") return {4, false, true};
    if (name == "unsigned_int" || name == "vtktypeuint32") return {4, false, false};
    if (name == "short") return {2, false, true};
    if (name == "unsigned_short") return {2, false, false};
    if (name == "char" || name == "signed_char" || name == "vtktypeint8") return {1, false, true};
    if (name == "unsigned_char" || name == "vtktypeuint8") return {1, false, false};
    text_.fail("a data type such as double or int", name);
  }

  /// The next `count` numbers, of any kind, not a number and infinity among them.
  std::vector<double> read_reals(const BinaryType& type, std::size_t count) {
    text_.checked_count(static_cast<std::int64_t>(std::min(count, std::size_t{1} << 62)), "values",
                        is_binary_ ? type.size : 2);
    std::vector<double> values;
    values.reserve(count);
    if (is_binary_) text_.skip_line_end();
    for (std::size_t i = 0; i < count; ++i) {
      if (is_binary_) {
        values.push_back(decoded(text_.bytes(type.size, "a value"), type, std::endian::big));
        continue;
      }
      const std::string_view word = text_.word("a value");
      double value = 0;
      if (!parse_real(word, value)) text_.fail("a number", word);
      values.push_back(value);
    }
    return values;
  }

  /// The next `count` indices; a binary one that is no index becomes -1.
  std::vector<std::int64_t> read_integers(const BinaryType& type, std::size_t count, std::string_view what) {
    std::vector<std::int64_t> values;
    if (!is_binary_) {
      text_.checked_count(static_cast<std::int64_t>(std::min(count, std::size_t{1} << 62)), what, 2);
      for (std::size_t i = 0; i < count; ++i) values.push_back(text_.integer(what));
      return values;
    }
    for (const double value : read_reals(type, count)) {
      values.push_back(std::abs(value) < 1e15 ? static_cast<std::int64_t>(value) : -1);
    }
    return values;
  }

  void read_points() {
    if (has_points_) text_.fail("one section POINTS", "a second one");
    has_points_ = true;
    const std::size_t count = text_.count("points", is_binary_ ? 12 : 6);
    const BinaryType point_type = type();
    if (!is_binary_) {
      for (std::size_t i = 0; i < count; ++i) {
        mesh_.add_vertex(static_cast<std::int64_t>(i),
                         text_.point("a coordinate of point " + std::to_string(i)));
      }
    } else {
      const std::vector<double> values = read_reals(point_type, 3 * count);
      for (std::size_t i = 0; i < count; ++i) {
        const Vector3 position(values[3 * i], values[3 * i + 1], values[3 * i + 2]);
        if (!position.allFinite()) {
          throw InputError(text_.file() + ": POINTS: point " + std::to_string(i), "finite coordinates",
                           "not finite");
        }
        mesh_.add_vertex(static_cast<std::int64_t>(i), position);
      }
    }
    mesh_.finish_vertices();
    if (dataset_ != Dataset::structured) return;
    const auto [nx, ny, nz] = dimensions_;
    if (nx > count || ny > count || nz > count || nx * ny > count || nx * ny * nz != count)
      text_.fail("as many points as DIMENSIONS says", std::to_string(count));
    add_structured_cells();
  }

  /// Lists of points, one after another in `points`.
  struct Lists {
    std::vector<std::int64_t> points;
    std::vector<std::pair<std::size_t, std::size_t>> ranges;  ///< first entry and number of points of each
  };

  Lists read_lists(const std::string& keyword) {
    Lists lists;
    const std::size_t first = text_.count("cells", 1);
    const std::size_t second = text_.count("entries of " + keyword + " (sizes and indices into POINTS)", 1);
    if (text_.peek() == "OFFSETS") return read_offset_lists(keyword, first, second);
    const std::string entry =
        "one of the " + std::to_string(second) + " entries of " + keyword + ", sizes and indices";
    lists.points = read_integers({4, false, true}, second, entry);
    const std::int64_t most = keyword == "CELLS" ? 27 : std::numeric_limits<std::int32_t>::max();
    std::size_t at = 0;
    for (std::size_t i = 0; i < first; ++i) {
      if (at >= second) fail_at_sizes(keyword, first, second, "enough for " + std::to_string(i) + " cells");
      const std::int64_t size = lists.points[at];
      if (size < 1 || size > most)
        fail_at_cell(keyword, i, "a number of points from 1 to " + std::to_string(most), size);
      const std::size_t begin = at + 1;
      at = begin + static_cast<std::size_t>(size);
      if (at > second)
        fail_at_sizes(keyword, first, second, "cell " + std::to_string(i) + " ends at " + std::to_string(at));
      lists.ranges.emplace_back(begin, static_cast<std::size_t>(size));
    }
    if (at != second) fail_at_sizes(keyword, first, second, "cells that take " + std::to_string(at));
    return lists;
  }

  /// Since version 5: where each cell begins, and the end; then all indices.
  Lists read_offset_lists(const std::string& section, std::size_t first, std::size_t second) {
    Lists lists;
    text_.word("");
    const auto offsets =
        read_integers(type(), first, "one of the " + std::to_string(first) + " offsets of " + section);
    const std::string_view keyword = text_.word("CONNECTIVITY");
    if (keyword != "CONNECTIVITY")
      text_.fail("CONNECTIVITY after the " + std::to_string(first) + " offsets of " + section,
                 printable(keyword));
    lists.points =
        read_integers(type(), second, "one of the " + std::to_string(second) + " indices of " + section);
    for (std::size_t i = 0; i < offsets.size(); ++i) {
      const std::int64_t least = i == 0 ? 0 : offsets[i - 1];
      const bool is_bounded = offsets[i] >= least && offsets[i] <= static_cast<std::int64_t>(second);
      if (!is_bounded || (i == 0 && offsets[0] != 0) ||
          (i + 1 == offsets.size() && offsets[i] != static_cast<std::int64_t>(second))) {
        throw InputError(text_.file() + ": " + section,
                         "offsets that rise from 0 to the " + std::to_string(second) + " entries",
                         "offset " + std::to_string(i) + " = " + std::to_string(offsets[i]));
      }
      if (i > 0)
        lists.ranges.emplace_back(static_cast<std::size_t>(least),
                                  static_cast<std::size_t>(offsets[i] - least));
    }
    return lists;
  }

  /// Refuses a section of cells whose first line promises `first` of them in `second` entries.
  [[noreturn]] void fail_at_sizes(const std::string& section, std::size_t first, std::size_t second,
                                  const std::string& got) const {
    throw InputError(
        text_.file() + ": " + section,
        std::to_string(first) + " cells in " + std::to_string(second) + " entries, as its first line says",
        got, "the sizes of the cells and those in the first line do not go together");
  }

  [[noreturn]] void fail_at_cell(const std::string& section, std::size_t cell, const std::string& expected,
                                 std::int64_t got) const {
    throw InputError(text_.file() + ": " + section + ": cell " + std::to_string(cell), expected,
                     std::to_string(got));
  }

  void read_cell_types() {
    if (has_types_) text_.fail("one section CELL_TYPES", "a second one");
    has_types_ = true;
    const std::size_t count = text_.count("cell types", 1);
    if (count != cells_.ranges.size()) {
      text_.fail(std::to_string(cells_.ranges.size()) + " cell types, as many as CELLS",
                 std::to_string(count));
    }
    const auto types = read_integers({4, false, true}, count, "a cell type");
    for (std::size_t i = 0; i < count; ++i) {
      const auto [begin, size] = cells_.ranges[i];
      const auto points = std::span(cells_.points).subspan(begin, size);
      const auto found = vtk_cell(types[i], size);
      if (!found) {
        throw InputError(mesh_.cell_place(static_cast<std::int64_t>(i)),
                         "a cell type that can be read, such as 5 (triangle) or 10 (tetrahedron)",
                         std::to_string(types[i]));
      }
      if (size != found->num_nodes) {
        fail_at_cell(
            "CELLS", i,
            std::to_string(found->num_nodes) + " points, as its type " + std::to_string(types[i]) + " has",
            static_cast<std::int64_t>(size));
      }
      for (const MeshBuilder::Cell& cell : add_vtk_cell(mesh_, *found, static_cast<std::int64_t>(i), points))
        pieces_.push_back({cell, i});
    }
    num_cells_ = count;
  }

  void add_polygons(const Lists& lists, const std::string& section) {
    for (const auto& [begin, size] : lists.ranges) {
      const std::size_t number = num_cells_++;
      if (size < 3) fail_at_cell(section, number, "at least 3 points", static_cast<std::int64_t>(size));
      const auto points = std::span(lists.points).subspan(begin, size);
      for (const MeshBuilder::Cell& cell :
           mesh_.add_polygon(static_cast<std::int64_t>(number), points, section == "TRIANGLE_STRIPS"))
        pieces_.push_back({cell, number});
    }
  }

  /// Numbers of points along the three directions; POINTS follow.
  void read_dimensions() {
    for (std::size_t& size : dimensions_)
      size = std::max<std::size_t>(1, text_.count("points of a direction", 1));
  }

  /// Hexahedra between the points of a structured grid, quadrilaterals where it has one layer of points.
  void add_structured_cells() {
    const auto [nx, ny, nz] = dimensions_;
    const auto point = [&](std::size_t i, std::size_t k, std::size_t l) {
      return static_cast<std::int64_t>(i + nx * (k + ny * l));
    };
    const bool is_flat = nz == 1;
    for (std::size_t l = 0; l + 1 < std::max<std::size_t>(nz, 2); ++l)
      for (std::size_t k = 0; k + 1 < ny; ++k)
        for (std::size_t i = 0; i + 1 < nx; ++i) {
          std::vector<std::int64_t> nodes = {point(i, k, l), point(i + 1, k, l), point(i + 1, k + 1, l),
                                             point(i, k + 1, l)};
          if (!is_flat)
            for (std::size_t n = 0; n < 4; ++n)
              nodes.push_back(nodes[n] + static_cast<std::int64_t>(nx * ny));
          const CellKind kind = is_flat ? CellKind::quadrilateral : CellKind::hexahedron;
          pieces_.push_back(
              {mesh_.add_cell_of_numbers(kind, static_cast<std::int64_t>(num_cells_), nodes), num_cells_});
          ++num_cells_;
        }
  }

  void read_scalars() {
    const std::string name(text_.word("a name"));
    const BinaryType value_type = type();
    const std::size_t components = text_.is_line_done() ? 1 : text_.count("components", 1);
    if (text_.peek() == "LOOKUP_TABLE") {
      text_.word("");
      text_.word("the name of a table");
    }
    keep(name, components, read_reals(value_type, num_data_ * components));
  }

  void read_field() {
    text_.word("a name");
    const std::size_t num_arrays = text_.count("arrays", 4);
    for (std::size_t i = 0; i < num_arrays; ++i) {
      while (text_.peek() == "METADATA") read_part(std::string(text_.word("")));
      const std::string name(text_.word("a name"));
      const std::size_t components = text_.count("components", 1);
      const std::size_t tuples = text_.count("tuples", 1);
      keep(name, components, read_reals(type(), components * tuples));
    }
  }

  /// A scalar per cell becomes a cell field.
  void keep(const std::string& name, std::size_t components, const std::vector<double>& values) {
    if (!is_cell_data_ || components != 1 || values.size() != num_cells_) return;
    for (const Piece& piece : pieces_) mesh_.set_cell_value(name, piece.cell, values[piece.number]);
  }

  /// A cell, or one of the triangles of a polygon of the file.
  struct Piece {
    MeshBuilder::Cell cell;
    std::size_t number;  ///< in the file
  };
  static constexpr BinaryType colour_{1, false, false};  ///< in text a number from 0 to 1
  enum class Dataset { unstructured, structured, surface };

  TextScanner text_;
  MeshBuilder mesh_;
  Dataset dataset_ = Dataset::unstructured;
  bool is_binary_ = false;
  bool has_points_ = false;
  bool has_cells_ = false;
  bool has_types_ = false;
  bool is_cell_data_ = false;
  std::size_t num_data_ = 0;
  Lists cells_;
  std::array<std::size_t, 3> dimensions_ = {0, 0, 0};
  std::vector<Piece> pieces_;
  std::size_t num_cells_ = 0;  ///< in the file
};

}  // namespace

MeshFile read_vtk(const MeshSource& source) { return VtkReader(source).read(); }

}  // namespace resilin
