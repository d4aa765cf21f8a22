#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "resilin/core/error.hpp"
#include "resilin/io/binary_value.hpp"
#include "resilin/io/catalog.hpp"
#include "resilin/io/mesh_builder.hpp"
#include "resilin/io/text_scanner.hpp"

// PLY surfaces, ASCII and binary of both byte orders: positions and polygons. Other elements and properties,
// such as normals and colours, are passed over.
// Source: G. Turk, "The PLY Polygon File Format", Stanford University 1994.

namespace resilin {
namespace {

struct PlyProperty {
  std::string name;
  BinaryType type;
  std::optional<BinaryType> count_type;  ///< count type of a list: how its length is kept
};

struct PlyElement {
  std::string name;
  std::int64_t count = 0;
  std::vector<PlyProperty> properties;
  std::int64_t line = 0;  ///< line of the header

  /// -1 when there is none of these names.
  int find(std::initializer_list<std::string_view> names) const {
    for (std::size_t i = 0; i < properties.size(); ++i)
      if (std::ranges::find(names, properties[i].name) != names.end()) return static_cast<int>(i);
    return -1;
  }
  /// Least number of bytes that each takes in the file.
  std::size_t least_bytes(bool is_binary) const {
    std::size_t sum = 0;
    for (const PlyProperty& property : properties)
      sum += is_binary ? property.count_type.value_or(property.type).size : 2;
    return sum;
  }
};

class PlyReader {
 public:
  explicit PlyReader(const MeshSource& source)
      : text_(source.name, source.bytes), mesh_(source.name, "PLY", "face") {}

  MeshFile read() {
    read_header();
    for (const PlyElement& element : elements_) read_element(element);
    if (!text_.at_end())
      throw InputError(text_.file(), "the end of the file behind the elements that its header counts",
                       std::to_string(text_.remaining()) + " more bytes");
    if (!has_vertices_) throw InputError(text_.file(), "expected an element vertex, got none");
    if (faces_.empty())
      throw InputError(text_.file(),
                       "no faces (an element face with a list vertex_indices): points alone are "
                       "no surface");
    mesh_.finish_vertices();
    for (const Face& face : faces_) add(face);
    return mesh_.finish();
  }

 private:
  void read_header() {
    const std::string_view first = text_.rest_of_line();
    if (first != "ply") throw InputError(text_.file() + ": line 1", "\"ply\"", printable(first));
    text_.set_section("the header");
    bool has_format = false;
    while (true) {
      const std::string keyword(text_.word("a line of the header"));
      if (keyword == "end_header") break;
      if (keyword == "format") {
        read_format();
        has_format = true;
      } else if (keyword == "element") {
        read_element_line();
      } else if (keyword == "property") {
        read_property_line();
      } else if (keyword != "comment" && keyword != "obj_info") {
        text_.fail("format, element, property, comment or end_header", keyword);
      }
      text_.rest_of_line();
    }
    text_.rest_of_line();
    if (!has_format) text_.fail("a line \"format ascii 1.0\" in the header", "none");
  }

  void read_format() {
    const std::string_view name = text_.word("a format");
    if (name != "ascii" && name != "binary_little_endian" && name != "binary_big_endian")
      text_.fail("ascii, binary_little_endian or binary_big_endian", name);
    is_binary_ = name != "ascii";
    order_ = name == "binary_big_endian" ? std::endian::big : std::endian::little;
    const std::string_view version = text_.word("a version");
    if (version != "1.0") text_.fail("version 1.0", version);
  }

  void read_element_line() {
    PlyElement element;
    element.name = text_.word("the name of an element");
    element.count = text_.integer("the number of its entries");
    element.line = text_.line();
    if (element.count < 0) text_.fail("a number of entries >= 0", std::to_string(element.count));
    const bool is_twice = std::ranges::find(elements_, element.name, &PlyElement::name) != elements_.end();
    if (is_twice) text_.fail("each element once", element.name + " again");
    elements_.push_back(std::move(element));
  }

  void read_property_line() {
    if (elements_.empty()) text_.fail("an element before its properties", "property");
    const std::string_view word = text_.word("a type");
    std::optional<BinaryType> count_type;
    if (word == "list") count_type = type_of(text_.word("the type of a length"));
    const BinaryType type = type_of(count_type ? text_.word("a type") : word);
    if (count_type && count_type->is_real) text_.fail("a whole number as the length of a list", "a real one");
    elements_.back().properties.push_back(
        {std::string(text_.word("the name of a property")), type, count_type});
  }

  BinaryType type_of(std::string_view name) const {
    if (name == "float" || name == "float32") return {4, true, true};
    if (name == "double" || name == "float64") return {8, true, true};
    if (name == "char" || name == "int8") return {1, false, true};
    if (name == "uchar" || name == "uint8") return {1, false, false};
    if (name == "short" || name == "int16") return {2, false, true};
    if (name == "ushort" || name == "uint16") return {2, false, false};
    if (name == "int" || name == "int32") return {4, false, true};
    if (name == "uint" || name == "uint32") return {4, false, false};
    text_.fail("a type such as float, double, uchar or int", name);
  }

  /// The next number of the body; in text of any kind, not a number among them.
  double value(const BinaryType& type, const std::string& what) {
    if (is_binary_) return decoded(text_.bytes(type.size, what), type, order_);
    const std::string_view word = text_.word(what);
    double number = 0;
    if (!parse_real(word, number)) text_.fail(what, word);
    return number;
  }

  std::string place_of(const PlyElement& element, std::int64_t number) const {
    return is_binary_ ? text_.file() + ": " + element.name + " " + std::to_string(number) : text_.place();
  }

  void read_element(const PlyElement& element) {
    if (element.count == 0) return;
    if (element.properties.empty())
      throw InputError(text_.file() + ": line " + std::to_string(element.line),
                       "properties of element " + printable(element.name), "none");
    text_.set_section("element " + printable(element.name));
    what_ = "a number of element " + printable(element.name);
    text_.checked_count(element.count, "entries of element " + printable(element.name),
                        element.least_bytes(is_binary_));
    if (element.name == "vertex") return read_vertices(element);
    if (element.name == "face") return read_faces(element);
    for (std::int64_t i = 0; i < element.count; ++i) read_entry(element, i);
  }

  /// All numbers of an entry: the scalars and, in `list_`, the list number `wanted_list`.
  void read_entry(const PlyElement& element, std::int64_t number, int wanted_list = -1) {
    numbers_.clear();
    for (std::size_t p = 0; p < element.properties.size(); ++p) {
      const PlyProperty& property = element.properties[p];
      if (!property.count_type) {
        numbers_.push_back(value(property.type, what_));
        continue;
      }
      numbers_.push_back(0);
      const double length = value(*property.count_type, what_);
      if (!(length >= 0 && length < 1e9 && length == std::floor(length)))
        throw InputError(place_of(element, number),
                         "a length of the list " + printable(property.name) + " >= 0", "another number");
      const std::size_t size = text_.checked_count(static_cast<std::int64_t>(length),
                                                   "entries of a list " + printable(property.name),
                                                   is_binary_ ? property.type.size : 2);
      const bool is_wanted = static_cast<int>(p) == wanted_list;
      if (is_wanted) list_.clear();
      for (std::size_t i = 0; i < size; ++i) {
        const double entry = value(property.type, what_);
        if (is_wanted) list_.push_back(entry);
      }
    }
  }

  void read_vertices(const PlyElement& element) {
    has_vertices_ = true;
    const std::array<int, 3> axes = {element.find({"x"}), element.find({"y"}), element.find({"z"})};
    for (const int axis : axes) {
      if (axis >= 0 && !element.properties[static_cast<std::size_t>(axis)].count_type) continue;
      throw InputError(text_.file() + ": line " + std::to_string(element.line),
                       "properties x, y and z of element vertex", "not all of them");
    }
    for (std::int64_t i = 0; i < element.count; ++i) {
      read_entry(element, i);
      Vector3 position;
      for (int a = 0; a < 3; ++a)
        position[a] = numbers_[static_cast<std::size_t>(axes[static_cast<std::size_t>(a)])];
      if (!position.allFinite())
        throw InputError(place_of(element, i), "finite coordinates of vertex " + std::to_string(i),
                         "inf or nan");
      mesh_.add_vertex(i, position);
    }
  }

  void read_faces(const PlyElement& element) {
    const int list = element.find({"vertex_indices", "vertex_index"});
    if (list < 0 || !element.properties[static_cast<std::size_t>(list)].count_type)
      throw InputError(text_.file() + ": line " + std::to_string(element.line),
                       "a list vertex_indices of element face", "none");
    for (std::int64_t i = 0; i < element.count; ++i) {
      read_entry(element, i, list);
      if (list_.size() < 3)
        throw InputError(place_of(element, i), "at least 3 vertices of face " + std::to_string(i),
                         std::to_string(list_.size()));
      for (std::size_t k = 2; k < list_.size(); ++k)
        faces_.push_back({i, {list_[0], list_[k - 1], list_[k]}});
    }
  }

  /// A triangle as the file gives it: vertices may still follow.
  struct Face {
    std::int64_t number;
    std::array<double, 3> vertices;
  };

  void add(const Face& face) {
    std::array<Index, 3> nodes{};
    for (std::size_t k = 0; k < 3; ++k) {
      const double number = face.vertices[k];
      const bool is_index = number >= 0 && number < 1e15 && number == std::floor(number);
      nodes[k] = mesh_.vertex(is_index ? static_cast<std::int64_t>(number) : -1, face.number);
    }
    mesh_.add_cell(CellKind::triangle, face.number, nodes);
  }

  TextScanner text_;
  MeshBuilder mesh_;
  bool is_binary_ = false;
  std::endian order_ = std::endian::little;
  bool has_vertices_ = false;
  std::vector<PlyElement> elements_;
  std::string what_;             ///< is read, for messages
  std::vector<double> numbers_;  ///< numbers of the entry read last, one for each property
  std::vector<double> list_;     ///< list of the entry read last
  std::vector<Face> faces_;
};

}  // namespace

MeshFile read_ply(const MeshSource& source) { return PlyReader(source).read(); }

}  // namespace resilin
