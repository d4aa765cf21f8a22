#include <algorithm>
#include <array>
#include <deque>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "resilin/core/error.hpp"
#include "resilin/io/catalog.hpp"
#include "resilin/io/mesh_builder.hpp"
#include "resilin/io/text_scanner.hpp"
#include "resilin/io/xml.hpp"

// Meshes of FEBio: nodes, elements, and their sets and surfaces (the section Mesh of versions 3 and 4,
// Geometry of those before). Materials, conditions and steps are passed over. Source: "FEBio User's Manual",
// chapter 3.

namespace resilin {
namespace {

struct FebType {
  std::string_view name;
  CellKind kind;
  std::size_t num_nodes;
};
constexpr std::array<FebType, 22> feb_types = {
    {{"tet4", CellKind::tetrahedron, 4},     {"tet5", CellKind::tetrahedron, 5},
     {"tet10", CellKind::tetrahedron10, 10}, {"tet15", CellKind::tetrahedron, 15},
     {"tet20", CellKind::tetrahedron, 20},   {"hex8", CellKind::hexahedron, 8},
     {"hex20", CellKind::hexahedron, 20},    {"hex27", CellKind::hexahedron, 27},
     {"penta6", CellKind::prism, 6},         {"penta15", CellKind::prism, 15},
     {"pyra5", CellKind::pyramid, 5},        {"pyra13", CellKind::pyramid, 13},
     {"tri3", CellKind::triangle, 3},        {"tri6", CellKind::triangle6, 6},
     {"tri7", CellKind::triangle, 7},        {"quad4", CellKind::quadrilateral, 4},
     {"quad8", CellKind::quadrilateral, 8},  {"quad9", CellKind::quadrilateral, 9},
     {"q4", CellKind::quadrilateral, 4},     {"line2", CellKind::line, 2},
     {"line3", CellKind::line3, 3},          {"truss2", CellKind::line, 2}}};

/// The type that a word begins with: "tet10g4" is a tet10 with four points.
const FebType* feb_type(std::string_view word) {
  const std::string name = lower_case(word);
  const auto found = std::ranges::find_if(feb_types, [&](const FebType& type) {
    const bool ends =
        name.size() == type.name.size() || name[type.name.size()] < '0' || name[type.name.size()] > '9';
    return name.starts_with(type.name) && ends;
  });
  return found == feb_types.end() ? nullptr : &*found;
}

class FebReader {
 public:
  explicit FebReader(const MeshSource& source) : source_(&source), mesh_(source.name, "FEBio") {}

  MeshFile read() {
    open(source_->name, source_->bytes, /*is_main=*/true);
    for (const Document& document : documents_) read_nodes(document);
    mesh_.finish_vertices();
    for (const Document& document : documents_) read_materials(document);
    for (const Document& document : documents_) read_elements(document);
    elements_.sort();
    for (const Document& document : documents_) read_sets(document);
    return mesh_.finish();
  }

 private:
  struct Document {
    std::string name;
    std::string bytes_of_other;  ///< content of a file beside the main one
    std::string_view bytes;
    std::vector<XmlTag> tags;
  };

  /// A document and those that hold its mesh.
  void open(const std::string& name, std::string_view bytes, bool is_main) {
    Document& document = documents_.emplace_back();
    document.name = name;
    if (!is_main) document.bytes_of_other = bytes;
    document.bytes = is_main ? bytes : document.bytes_of_other;
    document.tags = xml_tags(name, document.bytes, "");
    if (document.tags.empty() || document.tags[0].name != "febio_spec")
      throw InputError(name, "<febio_spec>",
                       document.tags.empty() ? "no XML" : "<" + printable(document.tags[0].name) + ">");
    for (const XmlTag& tag : document.tags) {
      const std::string other = tag.attribute("from");
      if (!is_main || other.empty() || (tag.name != "Mesh" && tag.name != "Geometry")) continue;
      const std::string text =
          source_->file_beside(other, place(document, tag), "put the mesh into this file");
      open(std::filesystem::path(name).replace_filename(other).string(), text, /*is_main=*/false);
    }
  }

  static std::string place(const Document& document, const XmlTag& tag) {
    const auto end = document.bytes.begin() + static_cast<std::ptrdiff_t>(tag.text_begin);
    return document.name + ": line " + std::to_string(1 + std::count(document.bytes.begin(), end, '\n'));
  }

  [[noreturn]] static void fail(const Document& document, const XmlTag& tag, const std::string& expected,
                                std::string_view got, const std::string& cure = {}) {
    throw InputError(place(document, tag), expected, got.empty() ? "nothing" : printable(got), cure);
  }

  static bool is_of_mesh(const XmlTag& tag) { return tag.name == "Mesh" || tag.name == "Geometry"; }

  /// Calls `visit(parent, tag)` for each tag of a mesh, with the section of it that the tag stands in (null
  /// for the tag of a section itself).
  template <class Visit>
  static void for_each_tag(const Document& document, const Visit& visit) {
    bool is_in_mesh = false;
    const XmlTag* section = nullptr;
    for (const XmlTag& tag : document.tags) {
      if (is_of_mesh(tag)) {
        is_in_mesh = !tag.is_closed;
      } else if (tag.name == "/Mesh" || tag.name == "/Geometry") {
        is_in_mesh = false;
        section = nullptr;
      } else if (is_in_mesh && section != nullptr) {
        const bool is_end = tag.name.size() == section->name.size() + 1 &&
                            tag.name.ends_with(section->name) && tag.name[0] == '/';
        if (is_end)
          section = nullptr;
        else if (tag.name[0] != '/')
          visit(section, tag);
      } else if (is_in_mesh && tag.name[0] != '/') {
        visit(nullptr, tag);
        if (!tag.is_closed) section = &tag;
      }
    }
  }

  std::int64_t id(const Document& document, const XmlTag& tag, std::string_view text) const {
    std::int64_t number = 0;
    if (!parse_integer(text, number)) fail(document, tag, "a whole number as id", text);
    return number;
  }

  void read_nodes(const Document& document) {
    for_each_tag(document, [&](const XmlTag* section, const XmlTag& tag) {
      if (section == nullptr || section->name != "Nodes" || tag.name != "node") return;
      const std::int64_t number = id(document, tag, tag.attribute("id"));
      const std::vector<std::string_view> words = words_of(tag.text);
      if (words.size() != 3)
        fail(document, tag, "3 coordinates of node " + std::to_string(number), std::to_string(words.size()));
      Vector3 position;
      for (std::size_t i = 0; i < 3; ++i) {
        const NumberFault fault = read_real(words[i], "a coordinate of node " + std::to_string(number),
                                            position[static_cast<int>(i)]);
        if (!fault.expected.empty()) fail(document, tag, fault.expected, words[i], fault.cure);
      }
      const std::string name = section->attribute("name");
      if (!name.empty()) named_nodes_[name].push_back(mesh_.num_vertices());
      mesh_.add_vertex(number, position);
    });
  }

  void read_materials(const Document& document) {
    for (const XmlTag& tag : document.tags) {
      const std::string name = tag.attribute("name");
      if (tag.name == "material" && !name.empty()) materials_[tag.attribute("id")] = name;
    }
  }

  void read_elements(const Document& document) {
    for_each_tag(document, [&](const XmlTag* section, const XmlTag& tag) {
      if (section == nullptr || section->name != "Elements") return;
      const bool has_own_type = tag.name != "elem" && tag.name != "e";
      const std::string type_name = has_own_type ? tag.name : section->attribute("type");
      const FebType* type = feb_type(type_name);
      if (type == nullptr)
        fail(document, tag, "a type of elements such as tet4, tet10 or hex8", type_name,
             "export the mesh with another type");
      const std::int64_t number = id(document, tag, tag.attribute("id"));
      const auto cell = add_cell(document, tag, *type, number);
      elements_.add(number);
      cells_.push_back(cell);
      const std::string material = tag.attribute("mat", section->attribute("mat"));
      const std::string name = section->attribute("name");
      if (!name.empty()) mesh_.add_to_group(mesh_.group(name), cell);
      if (!material.empty()) mesh_.add_to_group(mesh_.group(material_name(type->kind, material)), cell);
    });
  }

  std::string material_name(CellKind kind, const std::string& material) const {
    const auto found = materials_.find(material);
    if (found != materials_.end()) return found->second;
    std::int64_t number = 0;
    return parse_integer(material, number) ? numbered_group_name(dimension(kind), number) : material;
  }

  MeshBuilder::Cell add_cell(const Document& document, const XmlTag& tag, const FebType& type,
                             std::int64_t number) {
    std::vector<std::int64_t> nodes;
    for (const std::string_view word : words_of(tag.text)) nodes.push_back(id(document, tag, word));
    if (nodes.size() != type.num_nodes)
      fail(document, tag,
           std::to_string(type.num_nodes) + " nodes of " + std::string(type.name) + " " +
               std::to_string(number),
           std::to_string(nodes.size()));
    return mesh_.add_cell_of_numbers(type.kind, number, nodes);
  }

  /// Sets name their members by tags such as <n id="3"/> or, since version 4, by a list of numbers.
  void read_sets(const Document& document) {
    for (const auto& [name, vertices] : named_nodes_)
      for (const Index vertex : vertices) mesh_.add_vertex_to_group(mesh_.group(name), vertex);
    named_nodes_.clear();
    for_each_tag(document, [&](const XmlTag* section, const XmlTag& tag) {
      const XmlTag& set = section == nullptr ? tag : *section;
      const std::string name = set.attribute("name");
      if (name.empty()) return;
      if (set.name == "NodeSet" || set.name == "ElementSet") {
        const bool is_of_nodes = set.name == "NodeSet";
        const std::string one = section == nullptr ? "" : tag.attribute("id");
        const std::vector<std::string_view> members =
            one.empty() ? words_of(tag.text) : std::vector<std::string_view>{one};
        for (const std::string_view member : members) add_member(document, tag, name, member, is_of_nodes);
      } else if ((set.name == "Surface" || set.name == "Edge") && section != nullptr) {
        const FebType* type = feb_type(tag.name);
        if (type == nullptr) fail(document, tag, "facets such as tri3 or quad4", tag.name);
        mesh_.add_to_group(mesh_.group(name),
                           add_cell(document, tag, *type, id(document, tag, tag.attribute("id", "0"))));
      }
    });
  }

  void add_member(const Document& document, const XmlTag& tag, const std::string& set, std::string_view word,
                  bool is_of_nodes) {
    const std::int64_t number = id(document, tag, word);
    const Index found = is_of_nodes ? mesh_.find_vertex(number) : elements_.find(number);
    if (found < 0)
      fail(document, tag,
           "the id of " + std::string(is_of_nodes ? "a node" : "an element") + " in \"" + printable(set) +
               "\"",
           word);
    if (is_of_nodes)
      mesh_.add_vertex_to_group(mesh_.group(set), found);
    else
      mesh_.add_to_group(mesh_.group(set), cells_[static_cast<std::size_t>(found)]);
  }

  const MeshSource* source_;
  MeshBuilder mesh_;
  std::deque<Document> documents_;
  std::map<std::string, std::string> materials_;
  std::map<std::string, std::vector<Index>> named_nodes_;
  NumberIndex elements_;
  std::vector<MeshBuilder::Cell> cells_;  ///< cells of each element
};

}  // namespace

MeshFile read_feb(const MeshSource& source) { return FebReader(source).read(); }

}  // namespace resilin
