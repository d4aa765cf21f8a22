#include <algorithm>
#include <array>
#include <span>
#include <string>
#include <vector>

#include "resilin/core/error.hpp"
#include "resilin/io/catalog.hpp"
#include "resilin/io/line_scanner.hpp"
#include "resilin/io/mesh_builder.hpp"
#include "resilin/io/text_scanner.hpp"

// Nastran bulk data: grid points and elements in small, large and free fields; properties are groups.
// Everything else is passed over. Source: MSC Nastran, "Quick Reference Guide", bulk data entries.

namespace resilin {
namespace {

struct BdfType {
  std::string_view name;
  CellKind first, second;  ///< by the corners alone, and with nodes in the middle of edges
  std::size_t num_corners, num_nodes;
};
constexpr std::array<BdfType, 11> bdf_types = {
    {{"ctetra", CellKind::tetrahedron, CellKind::tetrahedron10, 4, 10},
     {"chexa", CellKind::hexahedron, CellKind::hexahedron, 8, 20},
     {"cpenta", CellKind::prism, CellKind::prism, 6, 15},
     {"cpyram", CellKind::pyramid, CellKind::pyramid, 5, 13},
     {"ctria3", CellKind::triangle, CellKind::triangle, 3, 3},
     {"ctriar", CellKind::triangle, CellKind::triangle, 3, 3},
     {"ctria6", CellKind::triangle, CellKind::triangle6, 3, 6},
     {"cquad4", CellKind::quadrilateral, CellKind::quadrilateral, 4, 4},
     {"cquadr", CellKind::quadrilateral, CellKind::quadrilateral, 4, 4},
     {"cquad8", CellKind::quadrilateral, CellKind::quadrilateral, 4, 8},
     {"crod", CellKind::line, CellKind::line, 2, 2}}};

/// An entry: its name in small letters and its fields, those of continuations among them.
struct BdfEntry {
  std::string name;
  std::vector<std::string> fields;
  LineScanner at;  ///< the line on which it begins, for messages

  std::string field(std::size_t i) const { return i < fields.size() ? fields[i] : std::string(); }
};

class BdfReader {
 public:
  explicit BdfReader(const MeshSource& source)
      : lines_(source.name, source.bytes), mesh_(source.name, "Nastran") {}

  MeshFile read() {
    skip_to_bulk();
    while (next_entry()) read_entry();
    mesh_.finish_vertices();
    for (const Element& element : elements_) add_element(element);
    if (num_incomplete_ > 0)
      mesh_.warn(std::to_string(num_incomplete_) +
                 " elements have nodes in the middle of some edges only; their corners are used");
    return mesh_.finish();
  }

 private:
  struct Element {
    BdfType type;
    std::int64_t number;
    std::string property;  ///< empty where none is given
    std::size_t first_node, num_nodes;
  };

  /// Executive and case control come before "BEGIN BULK", where there is one.
  void skip_to_bulk() {
    LineScanner ahead = lines_;
    while (ahead.next()) {
      const std::string line = lower_case(trimmed(ahead.line()));
      if (!line.starts_with("begin") || line.find("bulk") == line.npos) continue;
      lines_ = ahead;
      return;
    }
  }

  static std::string_view without_comment(std::string_view line) {
    return line.substr(0, std::min(line.find('$'), line.size()));
  }

  /// Fields of a line: 8 of 8 characters behind the name, 4 of 16 in a large one, or between commas.
  static void add_fields(std::string_view line, std::vector<std::string>& fields) {
    if (line.find(',') != line.npos) {
      const std::vector<std::string_view> parts = split(line, ',');
      const std::size_t end = parts[0].find('*') != parts[0].npos ? 5 : 9;
      for (std::size_t i = 1; i < end; ++i)
        fields.emplace_back(i < parts.size() ? parts[i] : std::string_view());
      return;
    }
    std::string with_blanks;
    for (const char c : line) {
      if (c != '\t')
        with_blanks += c;
      else
        with_blanks.append(8 - with_blanks.size() % 8, ' ');
    }
    const std::string_view text = with_blanks;
    const bool is_large = text.substr(0, 8).find('*') != text.npos;
    const std::size_t width = is_large ? 16 : 8, count = is_large ? 4 : 8;
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t begin = 8 + i * width;
      fields.emplace_back(begin < text.size() ? trimmed(text.substr(begin, width)) : std::string_view());
    }
  }

  static bool is_continuation(std::string_view line) {
    return !line.empty() &&
           (line[0] == '+' || line[0] == '*' || line[0] == ',' || line[0] == ' ' || line[0] == '\t');
  }

  bool next_entry() {
    std::string_view line;
    do {
      if (!lines_.next()) return false;
      line = without_comment(lines_.line());
    } while (trimmed(line).empty());
    entry_ = {name_of(line), {}, lines_};
    if (entry_.name == "enddata") return false;
    if (!is_wanted(entry_.name)) return true;  // its continuations are entries without a name
    add_fields(line, entry_.fields);
    while (lines_.next()) {
      const std::string_view next = without_comment(lines_.line());
      if (trimmed(next).empty()) continue;
      if (!is_continuation(next)) {
        lines_.repeat();
        break;
      }
      add_fields(next, entry_.fields);
    }
    return true;
  }

  /// "GRID*  " and "GRID," are entries "grid".
  static std::string name_of(std::string_view line) {
    const std::string_view word =
        trimmed(line.substr(0, std::min(line.find_first_of(",\t"), std::size_t{8})));
    std::string name = lower_case(word.substr(0, std::min(word.find_first_of("* "), word.size())));
    return name;
  }

  static const BdfType* type_of(std::string_view name) {
    const auto found =
        std::ranges::find_if(bdf_types, [&](const BdfType& type) { return type.name == name; });
    return found == bdf_types.end() ? nullptr : &*found;
  }

  static bool is_wanted(std::string_view name) {
    return name == "grid" || name == "include" || type_of(name) != nullptr;
  }

  void read_entry() {
    if (entry_.name == "include")
      entry_.at.fail("all of the mesh in one file", "INCLUDE", "copy the included file into this one");
    if (entry_.name == "grid") read_grid();
    if (const BdfType* type = type_of(entry_.name)) read_element(*type);
  }

  static std::int64_t number(const BdfEntry& entry, std::size_t i, const std::string& what) {
    return entry.at.integer(entry.field(i), what);
  }

  void read_grid() {
    const std::int64_t node = number(entry_, 0, "the number of a grid point");
    const std::string system = entry_.field(1);
    if (!system.empty() && system != "0")
      entry_.at.fail("the basic coordinate system of grid point " + std::to_string(node), "system " + system,
                     "export the mesh in global coordinates");
    Vector3 position = Vector3::Zero();
    for (std::size_t i = 0; i < 3; ++i)
      if (!entry_.field(2 + i).empty())
        position[static_cast<int>(i)] =
            entry_.at.real(entry_.field(2 + i), "a coordinate of grid point " + std::to_string(node));
    mesh_.add_vertex(node, position);
  }

  /// "number, property, node, node, ..."; nodes in the middle of edges may be left out.
  void read_element(const BdfType& type) {
    Element element{type, number(entry_, 0, "the number of an element"), entry_.field(1), nodes_.size(), 0};
    const std::string what = "a node of element " + std::to_string(element.number);
    for (std::size_t n = 0; n < type.num_nodes; ++n) {
      const std::string field = entry_.field(2 + n);
      if (n >= type.num_corners && (field.empty() || field == "0")) break;
      nodes_.push_back(number(entry_, 2 + n, what));
      ++element.num_nodes;
    }
    if (!element.property.empty())
      number(entry_, 1, "the property of element " + std::to_string(element.number));
    elements_.push_back(element);  // grid points may follow
  }

  void add_element(const Element& element) {
    const BdfType& type = element.type;
    const bool has_all = element.num_nodes == type.num_nodes;
    if (!has_all && element.num_nodes > type.num_corners) ++num_incomplete_;
    const auto nodes =
        std::span(nodes_).subspan(element.first_node, has_all ? type.num_nodes : type.num_corners);
    const auto cell = mesh_.add_cell_of_numbers(has_all ? type.second : type.first, element.number, nodes);
    std::int64_t property = 0;
    if (parse_integer(element.property, property))
      mesh_.add_to_group(mesh_.group(numbered_group_name(dimension(type.first), property)), cell);
  }

  LineScanner lines_;
  MeshBuilder mesh_;
  BdfEntry entry_{"", {}, LineScanner("", "")};
  std::vector<Element> elements_;
  std::vector<std::int64_t> nodes_;  ///< nodes of all elements
  std::size_t num_incomplete_ = 0;
};

}  // namespace

MeshFile read_bdf(const MeshSource& source) { return BdfReader(source).read(); }

}  // namespace resilin
