#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <map>
#include <string>
#include <vector>

#include "resilin/core/error.hpp"
#include "resilin/core/memory.hpp"
#include "resilin/core/text.hpp"
#include "resilin/io/catalog.hpp"
#include "resilin/io/mesh_builder.hpp"
#include "resilin/io/text_scanner.hpp"
#include "resilin/io/xml.hpp"
#include "resilin/io/zip_archive.hpp"

// 3MF surfaces: the triangles of what the build places, each named object a group. Colours and materials are
// passed over. Source: 3MF Consortium, "3MF Core Specification" 1.3, chapters 3 and 4.

namespace resilin {
namespace {

constexpr std::size_t most_depth = 16, most_placings = 10000;

/// X -> A X + b.
struct Placing {
  Matrix<3> A = Matrix<3>::Identity();
  Vector3 b = Vector3::Zero();
};

struct Component {
  std::string object;
  Placing placing;
};

struct ModelObject {
  std::string name;
  std::vector<Vector3> vertices = {};
  std::vector<std::array<std::int64_t, 3>> triangles = {};
  std::vector<Component> components = {};
};

class ThreeMfReader {
 public:
  explicit ThreeMfReader(const MeshSource& source)
      : file_(source.name), mesh_(source.name, "3MF", "triangle") {
    const ZipArchive archive(source.name, source.bytes);
    const auto is_model = [](const ZipArchive::Entry& entry) {
      return lower_case(entry.name).ends_with(".model") && lower_case(entry.name).starts_with("3d/") &&
             std::ranges::count(entry.name, '/') == 1;
    };
    const auto found = std::ranges::find_if(archive.entries(), is_model);
    if (found == archive.entries().end())
      throw InputError(file_, "a model 3D/....model", "none", "it is no 3MF file");
    bytes_ = archive.content(*found);
    place_ = file_ + "/" + printable(found->name);
  }

  MeshFile read() {
    tags_ = xml_tags(place_, bytes_, "");
    if (tags_.empty() || local(tags_[0]) != "model") throw InputError(place_, "<model>", "something else");
    for (const XmlTag& tag : tags_) read_tag(tag);
    for (const Component& item : items_) place(item.object, item.placing, 0);
    mesh_.finish_vertices();
    add_triangles();
    const double metres = metres_of(tags_[0].attribute("unit", "millimeter"));
    mesh_.warn("its unit is " + printable(tags_[0].attribute("unit", "millimeter")) +
               "; lengths are read as metres (" + format_number(metres) + " m each)");
    return mesh_.finish();
  }

 private:
  /// Without the prefix of a namespace.
  static std::string_view local(const XmlTag& tag) {
    const std::string_view name = tag.name;
    return name.substr(name.find(':') == name.npos ? 0 : name.find(':') + 1);
  }

  std::string place_of(const XmlTag& tag) const {
    const auto end = bytes_.begin() + static_cast<std::ptrdiff_t>(tag.text_begin);
    return place_ + ": line " + std::to_string(1 + std::count(bytes_.begin(), end, '\n'));
  }

  double metres_of(const std::string& unit) const {
    static const std::map<std::string, double> units = {{"micron", 1e-6},     {"millimeter", 1e-3},
                                                        {"centimeter", 1e-2}, {"inch", 0.0254},
                                                        {"foot", 0.3048},     {"meter", 1}};
    const auto found = units.find(unit);
    if (found == units.end())
      throw InputError(place_, "the unit micron, millimeter, centimeter, inch, foot or meter",
                       printable(unit));
    return found->second;
  }

  double real(const XmlTag& tag, std::string_view text, std::string_view what) const {
    double value = 0;
    const NumberFault fault = read_real(text, what, value);
    if (!fault.expected.empty()) throw InputError(place_of(tag), fault.expected, printable(text), fault.cure);
    return value;
  }

  std::int64_t index(const XmlTag& tag, std::string_view key) const {
    const std::string text = tag.attribute(key);
    std::int64_t value = -1;
    if (!parse_integer(text, value))
      throw InputError(place_of(tag), "a vertex " + std::string(key), printable(text));
    return value;
  }

  /// "m00 m01 m02 m10 ... m32", by which a row vector is multiplied.
  Placing placing(const XmlTag& tag) const {
    Placing result;
    const std::string text = tag.attribute("transform");
    if (text.empty()) return result;
    const std::vector<std::string_view> words = words_of(text);
    if (words.size() != 12)
      throw InputError(place_of(tag), "12 numbers of a transform", std::to_string(words.size()));
    for (int row = 0; row < 4; ++row)
      for (int column = 0; column < 3; ++column) {
        const double value =
            real(tag, words[static_cast<std::size_t>(3 * row + column)], "a number of a transform");
        if (row < 3)
          result.A(column, row) = value;
        else
          result.b[column] = value;
      }
    return result;
  }

  void read_tag(const XmlTag& tag) {
    const std::string_view name = local(tag);
    if (name == "object") {
      object_ = &objects_[tag.attribute("id")];
      *object_ = {.name = tag.attribute("name")};
    } else if (name == "item") {
      items_.push_back({tag.attribute("objectid"), placing(tag)});
    } else if (object_ == nullptr) {
      return;
    } else if (name == "vertex") {
      Vector3 position;
      constexpr std::array<const char*, 3> axes = {"x", "y", "z"};
      for (int i = 0; i < 3; ++i) {
        const std::string text = tag.attribute(axes[static_cast<std::size_t>(i)]);
        position[i] = real(tag, text, "a coordinate " + std::string(axes[static_cast<std::size_t>(i)]));
      }
      object_->vertices.push_back(position);
    } else if (name == "triangle") {
      object_->triangles.push_back({index(tag, "v1"), index(tag, "v2"), index(tag, "v3")});
    } else if (name == "component") {
      object_->components.push_back({tag.attribute("objectid"), placing(tag)});
    }
  }

  void place(const std::string& id, const Placing& placing, std::size_t depth) {
    const auto found = objects_.find(id);
    if (found == objects_.end()) throw InputError(place_, "an object that the build names", printable(id));
    if (depth > most_depth || ++num_placings_ > most_placings)
      throw InputError(place_, "components without end in themselves", "object " + printable(id) + " again");
    const ModelObject& object = found->second;
    const double unit = metres_of(tags_[0].attribute("unit", "millimeter"));
    const double bytes = 100.0 * static_cast<double>(object.vertices.size() + object.triangles.size());
    if (!fits(bytes)) foresee_memory(bytes, "reading " + file_, "take a coarser mesh, or raise the limit");
    placed_.push_back({&object, mesh_.num_vertices(), placing.A.determinant() < 0});
    for (const Vector3& X : object.vertices) {
      const Vector3 position = unit * (placing.A * X + placing.b);
      if (!position.allFinite()) throw InputError(place_, "finite coordinates", "inf or nan");
      mesh_.add_vertex(mesh_.num_vertices(), position);
    }
    for (const Component& part : object.components)
      place(part.object, {placing.A * part.placing.A, placing.A * part.placing.b + placing.b}, depth + 1);
  }

  void add_triangles() {
    std::int64_t number = 0;
    for (const auto& [object, first, is_mirrored] : placed_)
      for (const std::array<std::int64_t, 3>& triangle : object->triangles) {
        std::array<Index, 3> nodes{};
        for (std::size_t i = 0; i < 3; ++i) {
          if (triangle[i] < 0 || triangle[i] >= static_cast<std::int64_t>(object->vertices.size()))
            throw InputError(
                mesh_.cell_place(number),
                "a vertex from 0 to " + std::to_string(object->vertices.size()) + " (not included)",
                std::to_string(triangle[i]));
          nodes[i] = first + static_cast<Index>(triangle[i]);
        }
        if (is_mirrored) std::swap(nodes[1], nodes[2]);
        const auto cell = mesh_.add_cell(CellKind::triangle, number++, nodes);
        if (!object->name.empty()) mesh_.add_to_group(mesh_.group(object->name), cell);
      }
  }

  struct Placed {
    const ModelObject* object;
    Index first;  ///< vertex
    bool is_mirrored;
  };

  std::string file_;
  std::string place_;  ///< file and model in it, for messages
  std::string bytes_;
  MeshBuilder mesh_;
  std::vector<XmlTag> tags_;
  std::map<std::string, ModelObject> objects_;
  ModelObject* object_ = nullptr;
  std::vector<Component> items_;
  std::vector<Placed> placed_;
  std::size_t num_placings_ = 0;
};

}  // namespace

MeshFile read_3mf(const MeshSource& source) { return ThreeMfReader(source).read(); }

}  // namespace resilin
