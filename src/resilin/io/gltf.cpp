#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "resilin/core/error.hpp"
#include "resilin/io/binary_value.hpp"
#include "resilin/io/catalog.hpp"
#include "resilin/io/gltf_buffers.hpp"
#include "resilin/io/mesh_builder.hpp"
#include "resilin/io/place_index.hpp"
#include "resilin/io/text_scanner.hpp"

// glTF 2.0 surfaces, as JSON (.gltf) and in one binary file (.glb): the triangles of the scene that is shown,
// placed by its nodes. Corners at exactly the same place become one vertex, since glTF parts surfaces where
// normals or textures jump. Materials, cameras, animations and skeletons are passed over.
// Source: Khronos Group, "glTF 2.0 Specification", 2021.

namespace resilin {
namespace {

using Json = nlohmann::json;
using Placement = Eigen::Affine3d;

constexpr std::size_t most_corners =
    300'000'000;  // most corners of all triangles, however often a mesh is used
constexpr std::string_view binary_start = "glTF";
constexpr std::size_t header_size = 12, chunk_header_size = 8;

/// The parts of a .glb file.
struct Container {
  std::string_view json, binary;
};

Container open_container(const MeshSource& source) {
  const std::string_view bytes = source.bytes;
  if (!bytes.starts_with(binary_start)) return {bytes, {}};
  const auto word = [&](std::size_t at) {
    return static_cast<std::size_t>(decoded(bytes.substr(at, 4), binary_uint32, std::endian::little));
  };
  const auto cut = [&](const std::string& expected) {
    return InputError(source.name, expected, std::to_string(bytes.size()) + " bytes", "the file may be cut");
  };
  if (bytes.size() < header_size + chunk_header_size) throw cut("a header of 20 bytes");
  if (word(4) != 2) throw InputError(source.name, "version 2 of glTF", std::to_string(word(4)));
  if (word(8) > bytes.size()) throw cut(std::to_string(word(8)) + " bytes, as the header says");
  const std::size_t json_size = word(header_size);
  const std::size_t begin = header_size + chunk_header_size;
  if (bytes.substr(header_size + 4, 4) != "JSON")
    throw InputError(source.name, "JSON first", "another chunk");
  if (json_size > bytes.size() - begin) throw cut("JSON of " + std::to_string(json_size) + " bytes");
  Container parts{bytes.substr(begin, json_size), {}};
  const std::size_t next = begin + json_size;
  if (bytes.size() < next + chunk_header_size) return parts;
  if (bytes.substr(next + 4, 3) != "BIN") return parts;
  if (word(next) > bytes.size() - next - chunk_header_size)
    throw cut("a buffer of " + std::to_string(word(next)) + " bytes");
  parts.binary = bytes.substr(next + chunk_header_size, word(next));
  return parts;
}

Json parse(const MeshSource& source, std::string_view text) {
  Json root = Json::parse(text, nullptr, /*allow_exceptions=*/false);
  if (!root.is_object()) throw InputError(source.name, "the JSON of glTF", "none", "the file may be cut");
  return root;
}

class GltfReader {
 public:
  explicit GltfReader(const MeshSource& source)
      : file_(source.name),
        parts_(open_container(source)),
        root_(parse(source, parts_.json)),
        buffers_(source, root_, parts_.binary),
        mesh_(source.name, "glTF", "triangle") {}

  MeshFile read() {
    refuse_what_is_packed();
    for (const std::size_t node : nodes_of_scene()) read_node(node, Placement::Identity());
    if (corners_.empty()) throw InputError(file_, "no triangles");
    for (std::size_t v = 0; v < places_.size(); ++v)
      mesh_.add_vertex(static_cast<std::int64_t>(v), places_.places()[v]);
    mesh_.finish_vertices();
    add_triangles();
    return mesh_.finish();
  }

 private:
  void refuse_what_is_packed() const {
    const auto version = root_.find("asset");
    if (version == root_.end() || !version->is_object() || !version->contains("version"))
      throw InputError(file_, "an \"asset\" with its \"version\", as glTF has", "none");
    const auto required = root_.find("extensionsRequired");
    if (required == root_.end() || !required->is_array()) return;
    for (const Json& name : *required) {
      if (!name.is_string()) continue;
      const auto& word = name.get_ref<const std::string&>();
      if (word.find("compression") != word.npos || word.find("quantization") != word.npos ||
          word.find("instancing") != word.npos)
        throw InputError(file_, "triangles without extensions", printable(word), "save it without");
    }
  }

  std::size_t size_of(const char* list) const {
    const auto found = root_.find(list);
    return found != root_.end() && found->is_array() ? found->size() : 0;
  }

  std::vector<std::size_t> numbers(const Json& object, const char* key, const std::string& place) const {
    std::vector<std::size_t> result;
    const auto list = object.find(key);
    if (list == object.end()) return result;
    if (!list->is_array()) throw InputError(place + ": " + key, "a list of numbers", "something else");
    for (const Json& entry : *list) {
      if (!entry.is_number_unsigned())
        throw InputError(place + ": " + key, "whole numbers from 0", "something else");
      result.push_back(entry.get<std::size_t>());
    }
    return result;
  }

  /// Nodes of the scene that the file shows; without scenes all nodes that are nobody's children.
  std::vector<std::size_t> nodes_of_scene() const {
    if (size_of("scenes") > 0) {
      const std::size_t scene = gltf_number(root_, "scene", file_, 0);
      return numbers(gltf_entry(root_, "scenes", scene, file_), "nodes",
                     file_ + ": scenes " + std::to_string(scene));
    }
    std::vector<bool> is_child(size_of("nodes"), false);
    for (std::size_t n = 0; n < is_child.size(); ++n)
      for (const std::size_t child :
           numbers(gltf_entry(root_, "nodes", n, file_), "children", file_ + ": nodes"))
        if (child < is_child.size()) is_child[child] = true;
    std::vector<std::size_t> roots;
    for (std::size_t n = 0; n < is_child.size(); ++n)
      if (!is_child[n]) roots.push_back(n);
    return roots;
  }

  template <std::size_t count>
  std::array<double, count> reals(const Json& node, const char* key, const std::string& place,
                                  const std::array<double, count>& otherwise) const {
    const auto found = node.find(key);
    if (found == node.end()) return otherwise;
    std::array<double, count> values{};
    const bool is_list = found->is_array() && found->size() == count;
    for (std::size_t i = 0; is_list && i < count; ++i) {
      if (!(*found)[i].is_number() || !std::isfinite((*found)[i].get<double>()))
        throw InputError(place + ": " + key, std::to_string(count) + " numbers", "something else");
      values[i] = (*found)[i].get<double>();
    }
    if (!is_list) throw InputError(place + ": " + key, std::to_string(count) + " numbers", "something else");
    return values;
  }

  Placement placement_of(const Json& node, const std::string& place) const {
    Placement result = Placement::Identity();
    if (node.contains("matrix")) {  // by columns
      const auto m = reals<16>(node, "matrix", place, {});
      for (int column = 0; column < 4; ++column)
        for (int row = 0; row < 3; ++row)
          result.matrix()(row, column) = m[static_cast<std::size_t>(4 * column + row)];
      return result;
    }
    const auto t = reals<3>(node, "translation", place, {0, 0, 0});
    const auto r = reals<4>(node, "rotation", place, {0, 0, 0, 1});  // x, y, z, w
    const auto s = reals<3>(node, "scale", place, {1, 1, 1});
    const Eigen::Quaterniond turn(r[3], r[0], r[1], r[2]);
    if (!(turn.norm() > 0)) throw InputError(place + ": rotation", "a quaternion of length 1", "length 0");
    result.translate(Vector3(t[0], t[1], t[2]));
    result.rotate(turn.normalized());
    result.scale(Vector3(s[0], s[1], s[2]));
    return result;
  }

  /// A node is in the tree once, so that none can be above itself.
  void read_node(std::size_t first, const Placement& above) {
    struct Open {
      std::size_t node;
      Placement above;
    };
    std::vector<Open> open = {{first, above}};
    while (!open.empty()) {
      const auto [number, outer] = open.back();
      open.pop_back();
      const std::string place = file_ + ": nodes " + std::to_string(number);
      const Json& node = gltf_entry(root_, "nodes", number, file_);
      if (is_read_.size() < size_of("nodes")) is_read_.resize(size_of("nodes"), false);
      if (is_read_[number]) throw InputError(place, "a node with one parent", "one that is met twice");
      is_read_[number] = true;
      const Placement placement = outer * placement_of(node, place);
      if (node.contains("mesh")) read_mesh_of(gltf_number(node, "mesh", place), placement);
      std::vector<std::size_t> children = numbers(node, "children", place);
      for (auto child = children.rbegin(); child != children.rend(); ++child)
        open.push_back({*child, placement});
    }
  }

  void read_mesh_of(std::size_t number, const Placement& placement) {
    const std::string place = file_ + ": meshes " + std::to_string(number);
    const Json& mesh = gltf_entry(root_, "meshes", number, file_);
    const auto primitives = mesh.find("primitives");
    if (primitives == mesh.end() || !primitives->is_array())
      throw InputError(place, "a list of primitives", "none");
    const std::size_t first = corners_.size() / 3;
    for (const Json& primitive : *primitives) read_primitive(primitive, place, placement);
    const auto name = mesh.find("name");
    if (name != mesh.end() && name->is_string() && !name->get_ref<const std::string&>().empty())
      groups_.push_back({name->get<std::string>(), first, corners_.size() / 3});
  }

  void read_primitive(const Json& primitive, const std::string& place, const Placement& placement) {
    constexpr std::size_t triangles = 4, strip = 5, fan = 6;
    const std::size_t mode = gltf_number(primitive, "mode", place, triangles);
    if (mode < triangles || mode > fan) {
      if (!std::exchange(has_passed_over_, true)) mesh_.warn("points and lines are skipped");
      return;
    }
    const auto attributes = primitive.find("attributes");
    if (attributes == primitive.end()) throw InputError(place, "attributes", "none");
    const std::vector<Vector3> positions = buffers_.positions(gltf_number(*attributes, "POSITION", place));
    std::vector<std::uint32_t> order;
    if (primitive.contains("indices")) {
      order = buffers_.indices(gltf_number(primitive, "indices", place));
    } else {
      for (std::size_t i = 0; i < positions.size(); ++i) order.push_back(static_cast<std::uint32_t>(i));
    }
    if (mode == triangles && order.size() % 3 != 0)
      throw InputError(place, "three corners for each triangle", std::to_string(order.size()) + " corners");
    std::vector<Index> vertices;
    for (const std::uint32_t i : order) {
      if (i >= positions.size())
        throw InputError(place, "an index below " + std::to_string(positions.size()), std::to_string(i));
      const Vector3 X = placement * positions[i];
      if (!X.allFinite()) throw InputError(place, "finite coordinates", "inf or nan once it is placed");
      vertices.push_back(places_.number_of(X));
    }
    const bool is_mirrored = placement.linear().determinant() < 0;
    const std::size_t step = mode == triangles ? 3 : 1;
    for (std::size_t i = 2; i < vertices.size(); i += step) {
      const bool is_turned = (mode == strip && i % 2 == 1) != is_mirrored;
      const Index a = vertices[mode == fan ? 0 : i - 2];
      add_triangle(a, vertices[is_turned ? i : i - 1], vertices[is_turned ? i - 1 : i]);
    }
  }

  /// Triangles whose corners are at the same place, as strips have them, are no part of the surface.
  void add_triangle(Index a, Index b, Index c) {
    if (a == b || b == c || c == a) return;
    if (corners_.size() >= most_corners)
      throw InputError(file_, "at most " + std::to_string(most_corners / 3) + " triangles", "more");
    corners_.insert(corners_.end(), {a, b, c});
  }

  void add_triangles() {
    std::vector<MeshBuilder::Cell> cells;
    for (std::size_t t = 0; t < corners_.size() / 3; ++t)
      cells.push_back(mesh_.add_cell(CellKind::triangle, static_cast<std::int64_t>(t),
                                     std::span(corners_).subspan(3 * t, 3)));
    for (const Named& named : groups_) {
      const std::size_t group = mesh_.group(named.name);
      for (std::size_t t = named.first; t < named.last; ++t) mesh_.add_to_group(group, cells[t]);
    }
  }

  struct Named {
    std::string name;
    std::size_t first, last;  ///< triangles
  };

  std::string file_;
  Container parts_;
  Json root_;
  GltfBuffers buffers_;
  MeshBuilder mesh_;
  PlaceIndex places_;
  std::vector<bool> is_read_;   ///< nodes
  std::vector<Index> corners_;  ///< three for each triangle
  std::vector<Named> groups_;   ///< named meshes, where they are placed
  bool has_passed_over_ = false;
};

}  // namespace

MeshFile read_gltf(const MeshSource& source) { return GltfReader(source).read(); }

}  // namespace resilin
