#include "resilin/io/msh_input.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <cstring>

#include "resilin/core/error.hpp"
#include "resilin/core/text.hpp"

namespace resilin {
namespace {

struct ElementType {
  int type;
  CellKind kind;
};

// Gmsh reference manual, section "MSH file format": the element types that we read.
constexpr std::array<ElementType, 11> element_types = {{{1, CellKind::line},
                                                        {2, CellKind::triangle},
                                                        {3, CellKind::quadrilateral},
                                                        {4, CellKind::tetrahedron},
                                                        {5, CellKind::hexahedron},
                                                        {6, CellKind::prism},
                                                        {7, CellKind::pyramid},
                                                        {8, CellKind::line3},
                                                        {9, CellKind::triangle6},
                                                        {11, CellKind::tetrahedron10},
                                                        {15, CellKind::point}}};

}  // namespace

template <class T>
T MshInput::binary(std::string_view what) {
  std::array<char, sizeof(T)> bytes;
  const std::string_view raw = text.bytes(sizeof(T), what);
  std::copy(raw.begin(), raw.end(), bytes.begin());
  if (swaps_bytes) std::reverse(bytes.begin(), bytes.end());
  T value;
  std::memcpy(&value, bytes.data(), sizeof(T));
  return value;
}

std::int64_t MshInput::integer(std::string_view what) {
  return is_binary ? binary<std::int32_t>(what) : text.integer(what);
}

std::int64_t MshInput::size(std::string_view what) {
  return is_binary ? binary<std::int64_t>(what) : text.integer(what);
}

double MshInput::real(std::string_view what) {
  if (!is_binary) return text.real(what);
  const auto value = binary<double>(what);
  if (!std::isfinite(value)) text.fail(std::string(what) + " that is finite", format_number(value));
  return value;
}

Vector3 MshInput::point(std::string_view what) {
  const double x = real(what);
  const double y = real(what);
  return {x, y, real(what)};
}

std::size_t MshInput::count(std::string_view what, std::size_t least_text_bytes, std::size_t binary_bytes) {
  const std::int64_t number = size("the number of " + std::string(what));
  return text.checked_count(number, what, is_binary ? binary_bytes : least_text_bytes);
}

std::optional<std::size_t> MshReading::group(int dimension, std::int64_t physical_tag) {
  if (physical_tag == 0) return std::nullopt;
  if (physical_tag < 0) physical_tag = physical_tag == INT64_MIN ? INT64_MAX : -physical_tag;
  const auto named = names.find({dimension, physical_tag});
  return mesh.group(named != names.end() ? named->second : numbered_group_name(dimension, physical_tag));
}

CellKind msh_cell_kind(const MeshBuilder& mesh, std::int64_t type, std::int64_t element) {
  for (const ElementType& known : element_types) {
    if (known.type == type) return known.kind;
  }
  throw InputError(mesh.cell_place(element),
                   "a line (1), triangle (2), tetrahedron (4), ... of first or second order",
                   "element type " + std::to_string(type));
}

int msh_element_type(CellKind kind) {
  const auto found = std::find_if(element_types.begin(), element_types.end(),
                                  [kind](const ElementType& known) { return known.kind == kind; });
  return found->type;
}

}  // namespace resilin
