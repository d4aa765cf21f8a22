#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "resilin/core/error.hpp"
#include "resilin/io/catalog.hpp"
#include "resilin/io/mesh_builder.hpp"
#include "resilin/io/text_scanner.hpp"
#include "resilin/io/vtu_decoder.hpp"
#include "resilin/io/xml.hpp"

// VTK XML surfaces (PolyData): points, polygons and strips of triangles. Vertices, lines and arrays of values
// are passed over. Source: Kitware, "VTK XML formats".

namespace resilin {
namespace {

class VtpReader {
 public:
  explicit VtpReader(const MeshSource& source)
      : file_(source.name),
        tags_(xml_tags(source.name, source.bytes, "AppendedData")),
        decoder_(source.name, source.bytes, vtk_root(source.name, tags_, "PolyData")),
        mesh_(source.name, "VTP", "polygon") {
    std::string_view rest = source.bytes;
    while (!rest.empty() && (rest.back() == '\n' || rest.back() == '\r' || rest.back() == ' '))
      rest.remove_suffix(1);
    if (!rest.ends_with("</VTKFile>"))
      throw InputError(file_, "</VTKFile> at the end", "none", "the file is cut");
  }

  MeshFile read() {
    sort_tags();
    const XmlTag& piece = pieces_[0];
    read_points(count(piece, "NumberOfPoints"));
    add_polygons(polygons_, count(piece, "NumberOfPolys"), /*is_strip=*/false);
    add_polygons(strips_, count(piece, "NumberOfStrips"), /*is_strip=*/true);
    if (num_polygons_ == 0)
      throw InputError(file_, "polygons", "none", "points and lines alone are no surface");
    decoder_.require_end(tags_);
    return mesh_.finish();
  }

 private:
  void sort_tags() {
    std::vector<XmlTag>* section = nullptr;
    for (const XmlTag& tag : tags_) {
      if (tag.name == "Points" && !tag.is_closed) section = &points_;
      if (tag.name == "Polys" && !tag.is_closed) section = &polygons_;
      if (tag.name == "Strips" && !tag.is_closed) section = &strips_;
      if (tag.name == "/Points" || tag.name == "/Polys" || tag.name == "/Strips") section = nullptr;
      if (tag.name == "DataArray" && section != nullptr) section->push_back(tag);
      if (tag.name == "Piece") pieces_.push_back(tag);
      if (tag.name == "AppendedData") decoder_.set_appended(tag);
    }
    if (pieces_.size() != 1)
      throw InputError(file_, "one <Piece>", std::to_string(pieces_.size()),
                       "join the pieces and save again");
  }

  std::int64_t count(const XmlTag& piece, const std::string& name) const {
    std::int64_t value = -1;
    const std::string text = piece.attribute(name, "0");
    if (!parse_integer(text, value) || value < 0)
      throw InputError(file_ + ": " + name, "a count", printable(text));
    return value;
  }

  /// The one array of a section of this name, or of any where it is empty.
  const XmlTag& array(const std::vector<XmlTag>& section, const std::string& name) const {
    const auto is_meant = [&](const XmlTag& tag) { return name.empty() || tag.attribute("Name") == name; };
    const auto found = std::ranges::count_if(section, is_meant);
    if (found != 1)
      throw InputError(file_, "one DataArray " + (name.empty() ? "of Points" : "\"" + name + "\""),
                       std::to_string(found), found == 0 ? "the file may be cut" : "");
    return *std::ranges::find_if(section, is_meant);
  }

  void read_points(std::int64_t num_points) {
    const XmlTag& tag = array(points_, "");
    if (const std::string given = tag.attribute("NumberOfComponents", "3"); given != "3")
      throw InputError(decoder_.place(tag), "NumberOfComponents 3", '"' + printable(given) + '"');
    const std::vector<double> X = decoder_.values(tag);
    if (static_cast<double>(X.size()) != 3 * static_cast<double>(num_points))
      throw InputError(decoder_.place(tag), "3 numbers for each of " + std::to_string(num_points) + " points",
                       std::to_string(X.size()), "the file may be cut");
    for (std::int64_t i = 0; i < num_points; ++i) {
      const double* x = X.data() + 3 * i;
      const Vector3 position(x[0], x[1], x[2]);
      if (!position.allFinite())
        throw InputError(file_ + ": point " + std::to_string(i), "finite coordinates", "inf or nan");
      mesh_.add_vertex(i, position);
    }
    mesh_.finish_vertices();
  }

  std::vector<std::int64_t> indices(const XmlTag& tag) const {
    std::vector<std::int64_t> result;
    for (const double value : decoder_.values(tag)) {
      if (!(std::abs(value) < 1e15 && std::nearbyint(value) == value))
        throw InputError(decoder_.place(tag), "whole numbers", "another number");
      result.push_back(static_cast<std::int64_t>(value));
    }
    return result;
  }

  void add_polygons(const std::vector<XmlTag>& section, std::int64_t promised, bool is_strip) {
    if (promised == 0) return;
    const XmlTag &connectivity_tag = array(section, "connectivity"), &offsets_tag = array(section, "offsets");
    const std::vector<std::int64_t> connectivity = indices(connectivity_tag), offsets = indices(offsets_tag);
    if (static_cast<std::int64_t>(offsets.size()) != promised)
      throw InputError(decoder_.place(offsets_tag), std::to_string(promised) + " values",
                       std::to_string(offsets.size()), "the file may be cut");
    std::int64_t begin = 0;
    for (const std::int64_t end : offsets) {
      const std::int64_t number = num_polygons_++;
      if (end < begin || end > static_cast<std::int64_t>(connectivity.size()))
        throw InputError(
            mesh_.cell_place(number),
            "an offset from " + std::to_string(begin) + " to " + std::to_string(connectivity.size()),
            std::to_string(end), "the file may be cut");
      if (end - begin < 3)
        throw InputError(mesh_.cell_place(number), "at least 3 points", std::to_string(end - begin));
      const auto size = static_cast<std::size_t>(end - begin);
      mesh_.add_polygon(number, std::span(connectivity).subspan(static_cast<std::size_t>(begin), size),
                        is_strip);
      begin = end;
    }
  }

  std::string file_;
  std::vector<XmlTag> tags_;
  VtuDecoder decoder_;
  MeshBuilder mesh_;
  std::vector<XmlTag> pieces_, points_, polygons_, strips_;  ///< tags of arrays, by section
  std::int64_t num_polygons_ = 0;
};

}  // namespace

MeshFile read_vtp(const MeshSource& source) { return VtpReader(source).read(); }

}  // namespace resilin
