#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "resilin/io/mesh_builder.hpp"
#include "resilin/io/text_scanner.hpp"

namespace resilin {

/// Numbers of an MSH file, in text or in binary of either byte order.
class MshInput {
 public:
  MshInput(const std::string& file, std::string_view bytes) : text(file, bytes) {}

  TextScanner text;
  double version = 0;
  bool is_binary = false;
  bool swaps_bytes = false;

  std::int64_t integer(std::string_view what);  ///< C int: 4 bytes
  std::int64_t size(std::string_view what);     ///< size_t: 8 bytes
  double real(std::string_view what);           ///< finite; 8 bytes
  Vector3 point(std::string_view what);
  /// A promised number of things of at least this many bytes each, as TextScanner::count.
  std::size_t count(std::string_view what, std::size_t least_text_bytes, std::size_t binary_bytes);

 private:
  template <class T>
  T binary(std::string_view what);
};

/// State that the sections of an MSH file share while it is read.
struct MshReading {
  MshInput in;
  MeshBuilder mesh;
  std::map<std::pair<int, std::int64_t>, std::string> names = {};  ///< (dimension, physical tag) -> name
  /// (dimension, entity tag) -> physical tags; version 4
  std::map<std::pair<int, std::int64_t>, std::vector<std::int64_t>> physicals = {};

  /// The mesh group of a physical tag; its sign is an orientation, 0 is no group.
  std::optional<std::size_t> group(int dimension, std::int64_t physical_tag);
};

/// The kind of cell of an MSH element type. @throws InputError naming the element
CellKind msh_cell_kind(const MeshBuilder& mesh, std::int64_t type, std::int64_t element);
/// The MSH element type of a kind.
int msh_element_type(CellKind kind);

// Sections by version; each stops before its $End keyword.
void read_msh1_elements(MshReading& file);
void read_msh2_nodes(MshReading& file);
void read_msh2_parametric_nodes(MshReading& file);
void read_msh2_elements(MshReading& file);
void read_msh4_entities(MshReading& file);
void read_msh4_nodes(MshReading& file);
void read_msh4_elements(MshReading& file);

}  // namespace resilin
