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

// Legacy VTK files with an unstructured grid, ASCII and binary (big endian), versions 1 to 5.1. Source:
// Kitware, "VTK file formats", simple legacy formats.

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
    if (has_cells_ && !has_types_)
      throw InputError(text_.file(), "no CELL_TYPES for the CELLS; the file may be cut");
    return mesh_.finish();
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
    if (dataset != "UNSTRUCTURED_GRID") text_.fail("DATASET UNSTRUCTURED_GRID", dataset);
  }

  void read_part(const std::string& keyword) {
    if (keyword == "POINTS") {
      read_points();
    } else if (keyword == "CELLS") {
      read_cells();
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
    } else if (keyword == "FIELD") {
      read_field();
    } else if (keyword == "METADATA") {
      text_.rest_of_line();
      while (text_.remaining() > 0 && !text_.rest_of_line().empty()) {
      }
    } else {
      text_.fail("POINTS, CELLS, CELL_TYPES, CELL_DATA, SCALARS, ...", keyword);
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
  }

  void read_cells() {
    if (has_cells_) text_.fail("one section CELLS", "a second one");
    has_cells_ = true;
    const std::size_t first = text_.count("cells", 1);
    const std::size_t second = text_.count("entries of CELLS (sizes and indices into POINTS)", 1);
    if (text_.peek() == "OFFSETS") return read_offset_cells(first, second);
    const std::string entry = "one of the " + std::to_string(second) + " entries of CELLS, sizes and indices";
    connectivity_ = read_integers({4, false, true}, second, entry);
    std::size_t at = 0;
    for (std::size_t i = 0; i < first; ++i) {
      if (at >= second) fail_at_sizes(first, second, "enough for " + std::to_string(i) + " cells");
      const std::int64_t size = connectivity_[at];
      if (size < 1 || size > 27) fail_at_cell(i, "a number of points from 1 to 27", size);
      const std::size_t begin = at + 1;
      at = begin + static_cast<std::size_t>(size);
      if (at > second)
        fail_at_sizes(first, second, "cell " + std::to_string(i) + " ends at " + std::to_string(at));
      ranges_.emplace_back(begin, static_cast<std::size_t>(size));
    }
    if (at != second) fail_at_sizes(first, second, "cells that take " + std::to_string(at));
  }

  /// Since version 5: where each cell begins, and the end; then all indices.
  void read_offset_cells(std::size_t first, std::size_t second) {
    text_.word("");
    const auto offsets =
        read_integers(type(), first, "one of the " + std::to_string(first) + " offsets of CELLS");
    const std::string_view keyword = text_.word("CONNECTIVITY");
    if (keyword != "CONNECTIVITY")
      text_.fail("CONNECTIVITY after the " + std::to_string(first) + " offsets of CELLS", printable(keyword));
    connectivity_ =
        read_integers(type(), second, "one of the " + std::to_string(second) + " indices of CELLS");
    for (std::size_t i = 0; i < offsets.size(); ++i) {
      const std::int64_t least = i == 0 ? 0 : offsets[i - 1];
      const bool is_bounded = offsets[i] >= least && offsets[i] <= static_cast<std::int64_t>(second);
      if (!is_bounded || (i == 0 && offsets[0] != 0) ||
          (i + 1 == offsets.size() && offsets[i] != static_cast<std::int64_t>(second))) {
        throw InputError(text_.file() + ": CELLS",
                         "offsets that rise from 0 to the " + std::to_string(second) + " entries",
                         "offset " + std::to_string(i) + " = " + std::to_string(offsets[i]));
      }
      if (i > 0)
        ranges_.emplace_back(static_cast<std::size_t>(least), static_cast<std::size_t>(offsets[i] - least));
    }
  }

  /// Refuses a section CELLS whose first line promises `first` cells in `second` entries.
  [[noreturn]] void fail_at_sizes(std::size_t first, std::size_t second, const std::string& got) const {
    throw InputError(
        text_.file() + ": CELLS",
        std::to_string(first) + " cells in " + std::to_string(second) + " entries, as its first line says",
        got, "the sizes of the cells and those in the first line do not go together");
  }

  [[noreturn]] void fail_at_cell(std::size_t cell, const std::string& expected, std::int64_t got) const {
    throw InputError(text_.file() + ": CELLS: cell " + std::to_string(cell), expected, std::to_string(got));
  }

  void read_cell_types() {
    if (has_types_) text_.fail("one section CELL_TYPES", "a second one");
    has_types_ = true;
    const std::size_t count = text_.count("cell types", 1);
    if (count != ranges_.size()) {
      text_.fail(std::to_string(ranges_.size()) + " cell types, as many as CELLS", std::to_string(count));
    }
    const auto types = read_integers({4, false, true}, count, "a cell type");
    std::array<Index, max_cell_nodes> nodes{};
    for (std::size_t i = 0; i < count; ++i) {
      const auto kind = kind_of_vtk_cell(types[i]);
      if (!kind) {
        throw InputError(mesh_.cell_place(static_cast<std::int64_t>(i)),
                         "a cell type that can be read, such as 5 (triangle) or 10 (tetrahedron)",
                         std::to_string(types[i]));
      }
      const auto [begin, size] = ranges_[i];
      if (size != static_cast<std::size_t>(num_nodes(*kind))) {
        fail_at_cell(
            i, std::to_string(num_nodes(*kind)) + " points, as its type " + std::to_string(types[i]) + " has",
            static_cast<std::int64_t>(size));
      }
      const auto number = static_cast<std::int64_t>(i);
      for (std::size_t n = 0; n < size; ++n)
        nodes[n] = mesh_.vertex(connectivity_[begin + n], number, *kind, n);
      exchange_vtk_nodes(*kind, std::span(nodes).first(size));
      cells_.push_back(mesh_.add_cell(*kind, number, std::span(nodes).first(size)));
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
    if (!is_cell_data_ || components != 1 || values.size() != cells_.size()) return;
    for (std::size_t i = 0; i < values.size(); ++i) mesh_.set_cell_value(name, cells_[i], values[i]);
  }

  TextScanner text_;
  MeshBuilder mesh_;
  bool is_binary_ = false;
  bool has_points_ = false;
  bool has_cells_ = false;
  bool has_types_ = false;
  bool is_cell_data_ = false;
  std::size_t num_data_ = 0;
  std::vector<std::int64_t> connectivity_;
  std::vector<std::pair<std::size_t, std::size_t>>
      ranges_;                            ///< first entry and number of points of each cell
  std::vector<MeshBuilder::Cell> cells_;  ///< in the order of the file
};

}  // namespace

MeshFile read_vtk(const MeshSource& source) { return VtkReader(source).read(); }

}  // namespace resilin
