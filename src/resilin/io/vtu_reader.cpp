#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "resilin/core/error.hpp"
#include "resilin/io/atomic_file.hpp"
#include "resilin/io/catalog.hpp"
#include "resilin/io/mesh_builder.hpp"
#include "resilin/io/text_scanner.hpp"
#include "resilin/io/vtu.hpp"
#include "resilin/io/vtu_decoder.hpp"
#include "resilin/io/xml.hpp"

namespace resilin {
namespace {

constexpr std::string_view group_prefix = "group:";

/// Start tags of the data arrays by the section that they stand in.
struct Arrays {
  std::vector<XmlTag> point_data;
  std::vector<XmlTag> cell_data;
  std::vector<XmlTag> points;
  std::vector<XmlTag> cells;
  std::vector<XmlTag> field_data;
  std::vector<XmlTag> piece;     ///< the Piece tag, one
  std::vector<XmlTag> appended;  ///< the AppendedData tag, at most one

  std::vector<XmlTag>* section(std::string_view name) {
    if (name == "PointData") return &point_data;
    if (name == "CellData") return &cell_data;
    if (name == "Points") return &points;
    if (name == "Cells") return &cells;
    if (name == "FieldData") return &field_data;
    return nullptr;
  }
};

class VtuReader {
 public:
  VtuReader(const std::string& file, std::string_view bytes)
      : file_(file),
        tags_(xml_tags(file, bytes, "AppendedData")),
        decoder_(file, bytes, vtk_root(file, tags_, "UnstructuredGrid")),
        mesh_(file, "VTU", "cell") {
    sort_tags();
  }

  VtuContent read() {
    read_points();
    read_cells();
    VtuContent content;
    for (const XmlTag& array : arrays_.point_data) {
      if (is_numeric(array)) content.point_data.push_back(values(array, num_points_));
    }
    for (const XmlTag& array : arrays_.cell_data) {
      if (is_numeric(array)) content.cell_data.push_back(values(array, num_cells_));
    }
    for (const XmlTag& array : arrays_.field_data) {
      const bool is_time = array.attribute("Name") == "TimeValue";
      if (!is_time && (!is_numeric(array) || array.attribute("NumberOfTuples", "") != "1")) continue;
      const std::vector<double> number = decoder_.values(array);
      if (number.size() != 1 || !std::isfinite(number[0])) continue;
      if (is_time)
        content.time = number[0];
      else
        content.numbers[array.attribute("Name")] = number[0];
    }
    decoder_.require_end(tags_);
    restore_groups(content);
    content.file = mesh_.finish();
    restore_fields(content);
    return content;
  }

 private:
  void sort_tags() {
    std::vector<XmlTag>* section = nullptr;
    std::map<std::string, int> times;
    for (const XmlTag& tag : tags_) {
      if (std::vector<XmlTag>* opened = arrays_.section(tag.name)) {
        section = tag.is_closed ? nullptr : opened;
        ++times[tag.name];
      }
      if (tag.name[0] == '/' && arrays_.section(tag.name.substr(1)) != nullptr) section = nullptr;
      if (tag.name == "DataArray" && section != nullptr) section->push_back(tag);
      if (tag.name == "Piece") arrays_.piece.push_back(tag);
      if (tag.name == "AppendedData") decoder_.set_appended(tag);
    }
    if (arrays_.piece.size() != 1)
      throw InputError(file_, "one <Piece>", std::to_string(arrays_.piece.size()));
    for (const char* name : {"Points", "Cells", "PointData", "CellData"})
      if (times[name] > 1)
        throw InputError(file_, "one <" + std::string(name) + ">", std::to_string(times[name]),
                         "remove the others: it is not clear which one holds");
  }

  std::size_t count(const std::string& attribute) const {
    std::int64_t value = -1;
    const std::string text = arrays_.piece[0].attribute(attribute);
    if (!parse_integer(text, value) || value < 0)
      throw InputError(file_ + ": " + attribute, "a count", printable(text));
    return static_cast<std::size_t>(value);
  }

  /// The array in one of the sections of the geometry, of this name where it has several.
  /// @param components  that it must have, where it says how many it has
  const XmlTag& array(const std::vector<XmlTag>& section, const std::string& name, int components) const {
    const auto is_meant = [&](const XmlTag& tag) { return name.empty() || tag.attribute("Name") == name; };
    const auto found = std::ranges::find_if(section, is_meant);
    const std::string what = name.empty() ? "of Points" : "\"" + name + "\"";
    if (found == section.end()) throw InputError(file_, "a DataArray " + what, "none", "the file may be cut");
    if (const auto count = std::ranges::count_if(section, is_meant); count > 1)
      throw InputError(file_, "one DataArray " + what, std::to_string(count));
    const std::string expected = std::to_string(components);
    if (const std::string given = found->attribute("NumberOfComponents", expected); given != expected)
      throw InputError(decoder_.place(*found), "NumberOfComponents " + expected,
                       '"' + printable(given) + '"');
    return *found;
  }

  /// Not text, which is passed over.
  static bool is_numeric(const XmlTag& array) { return array.attribute("type") != "String"; }

  void require_size(const XmlTag& tag, std::size_t found, std::size_t expected) const {
    if (found != expected) {
      throw InputError(decoder_.place(tag), std::to_string(expected) + " values", std::to_string(found),
                       "the file may be cut");
    }
  }

  VtuValues values(const XmlTag& tag, std::size_t count) const {
    std::int64_t components = 1;
    const std::string text = tag.attribute("NumberOfComponents", "1");
    if (!parse_integer(text, components) || components < 1 || components > 1000) {
      throw InputError(decoder_.place(tag), "1 to 1000 components", printable(text));
    }
    VtuValues result{tag.attribute("Name"), static_cast<int>(components), decoder_.values(tag)};
    require_size(tag, result.values.size(), count * static_cast<std::size_t>(components));
    return result;
  }

  std::vector<std::int64_t> indices(const std::string& name) const {
    const XmlTag& tag = array(arrays_.cells, name, 1);
    std::vector<std::int64_t> result;
    for (const double value : decoder_.values(tag)) {
      const bool is_index = std::abs(value) < 1e15 && std::nearbyint(value) == value;
      if (!is_index) throw InputError(decoder_.place(tag), "whole numbers", "another number");
      result.push_back(static_cast<std::int64_t>(value));
    }
    return result;
  }

  void read_points() {
    num_points_ = count("NumberOfPoints");
    const XmlTag& tag = array(arrays_.points, "", 3);
    const std::vector<double> X = decoder_.values(tag);
    if (num_points_ > X.size()) require_size(tag, X.size(), num_points_);
    require_size(tag, X.size(), 3 * num_points_);
    for (std::size_t i = 0; i < num_points_; ++i) {
      const Vector3 position(X[3 * i], X[3 * i + 1], X[3 * i + 2]);
      if (!position.allFinite())
        throw InputError(file_ + ": point " + std::to_string(i), "finite coordinates", "not finite");
      mesh_.add_vertex(static_cast<std::int64_t>(i), position);
    }
    mesh_.finish_vertices();
  }

  void read_cells() {
    const std::size_t num_cells = num_cells_ = count("NumberOfCells");
    const auto connectivity = indices("connectivity");
    const auto offsets = indices("offsets");
    const auto types = indices("types");
    require_size(array(arrays_.cells, "offsets", 1), offsets.size(), num_cells);
    require_size(array(arrays_.cells, "types", 1), types.size(), num_cells);
    std::int64_t begin = 0;
    for (std::size_t i = 0; i < num_cells; ++i) {
      const auto number = static_cast<std::int64_t>(i);
      const bool is_bounded =
          offsets[i] >= begin && offsets[i] <= static_cast<std::int64_t>(connectivity.size());
      const auto found = vtk_cell(types[i], is_bounded ? static_cast<std::size_t>(offsets[i] - begin) : 0);
      if (!found) {
        throw InputError(mesh_.cell_place(number),
                         "a cell type that can be read, such as 5 (triangle) or 10 (tetrahedron)",
                         std::to_string(types[i]));
      }
      const auto size = static_cast<std::int64_t>(found->num_nodes);
      if (!is_bounded || offsets[i] != begin + size) {
        throw InputError(mesh_.cell_place(number), "offset " + std::to_string(begin + size),
                         std::to_string(offsets[i]));
      }
      const auto points = std::span(connectivity).subspan(static_cast<std::size_t>(begin), found->num_nodes);
      for (const MeshBuilder::Cell& cell : add_vtk_cell(mesh_, *found, number, points))
        pieces_.push_back({cell, i});
      begin = offsets[i];
    }
  }

  /// Arrays "group:NAME" that `write_mesh` makes are groups again.
  void restore_groups(const VtuContent& content) {
    const auto is_group = [](const VtuValues& array) {
      return array.name.starts_with(group_prefix) && array.components == 1;
    };
    for (const VtuValues& array : content.cell_data) {
      if (!is_group(array)) continue;
      const std::size_t group = mesh_.group(array.name.substr(group_prefix.size()));
      for (const Piece& piece : pieces_)
        if (array.values[piece.number] == 1) mesh_.add_to_group(group, piece.cell);
    }
    for (const VtuValues& array : content.point_data) {
      if (!is_group(array)) continue;
      const std::size_t group = mesh_.group(array.name.substr(group_prefix.size()));
      for (std::size_t v = 0; v < num_points_; ++v) {
        if (array.values[v] == 1) mesh_.add_vertex_to_group(group, static_cast<Index>(v));
      }
    }
  }

  /// Scalars are fields of those blocks on which all values are finite.
  void restore_fields(VtuContent& content) const {
    Mesh& mesh = content.file.mesh;
    for (const VtuValues& array : content.cell_data) {
      if (array.components != 1 || array.name.starts_with(group_prefix)) continue;
      for (std::size_t b = 0; b < mesh.blocks.size(); ++b) {
        CellField field{array.name, b, {}};
        for (const Piece& piece : pieces_)
          if (piece.cell.block == b) field.values.push_back(array.values[piece.number]);
        const bool is_finite =
            std::all_of(field.values.begin(), field.values.end(), [](double v) { return std::isfinite(v); });
        if (is_finite) mesh.cell_fields.push_back(std::move(field));
      }
    }
  }

  /// A cell, or one of the triangles of a polygon of the file.
  struct Piece {
    MeshBuilder::Cell cell;
    std::size_t number;  ///< in the file
  };

  std::string file_;
  std::vector<XmlTag> tags_;
  VtuDecoder decoder_;
  MeshBuilder mesh_;
  Arrays arrays_;
  std::size_t num_points_ = 0;
  std::size_t num_cells_ = 0;  ///< in the file
  std::vector<Piece> pieces_;  ///< in the order of the file
};

}  // namespace

VtuContent read_vtu_from_memory(const std::string& name, std::string_view bytes) {
  return VtuReader(name, bytes).read();
}

VtuContent read_vtu(const std::filesystem::path& path) {
  return read_vtu_from_memory(path.string(), read_file(path));
}

MeshFile read_vtu_mesh(const MeshSource& source) {
  return read_vtu_from_memory(source.name, source.bytes).file;
}

}  // namespace resilin
