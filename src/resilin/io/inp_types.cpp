#include <array>
#include <charconv>

#include "resilin/io/inp_model.hpp"

// Types of elements and their sides. Source: Dassault Systemes, "Abaqus Analysis User's Guide", part VI;
// Dhondt, "CalculiX CrunchiX User's Manual", chapter 6.2.

namespace resilin {
namespace {

constexpr std::array solid_families = {"C3D", "DC3D", "DCC3D", "AC3D", "F3D", "CSS", "SC"};
constexpr std::array plane_families = {"CPEG", "CPE", "CPS", "CAX", "CGAX", "DC2D", "DCAX", "AC2D", "ACAX"};
constexpr std::array shell_families = {"S", "STRI", "DS", "M3D", "R3D", "SFM3D"};
constexpr std::array line_families = {"T3D", "T2D", "R2D", "RAX"};

struct NumberOfNodes {
  std::size_t in_file;
  CellKind kind;
};
constexpr std::array<NumberOfNodes, 8> solids = {{{4, CellKind::tetrahedron},
                                                  {10, CellKind::tetrahedron10},
                                                  {8, CellKind::hexahedron},
                                                  {20, CellKind::hexahedron},
                                                  {27, CellKind::hexahedron},
                                                  {6, CellKind::prism},
                                                  {15, CellKind::prism},
                                                  {5, CellKind::pyramid}}};
constexpr std::array<NumberOfNodes, 5> planes = {{{3, CellKind::triangle},
                                                  {6, CellKind::triangle6},
                                                  {4, CellKind::quadrilateral},
                                                  {8, CellKind::quadrilateral},
                                                  {9, CellKind::quadrilateral}}};
constexpr std::array<NumberOfNodes, 1> lines = {{{2, CellKind::line}}};

/// The number after the family's name; letters may follow, as the R of reduced integration. 0 for another
/// type.
std::size_t number_after(std::string_view type, std::string_view family) {
  if (!type.starts_with(family)) return 0;
  type.remove_prefix(family.size());
  std::size_t number = 0;
  const auto end = std::from_chars(type.data(), type.data() + type.size(), number);
  return end.ec == std::errc() ? number : 0;
}

std::optional<InpType> type_of(std::string_view type, std::span<const char* const> families,
                               std::span<const NumberOfNodes> known) {
  for (const char* family : families) {
    const std::size_t number = number_after(type, family);
    for (const NumberOfNodes& nodes : known)
      if (nodes.in_file == number) return InpType{nodes.kind, number};
  }
  return std::nullopt;
}

using Side = std::array<int, 4>;
constexpr std::array<Side, 4> tetrahedron_sides_of_inp = {
    {{0, 1, 2, -1}, {0, 3, 1, -1}, {1, 3, 2, -1}, {2, 3, 0, -1}}};
constexpr std::array<Side, 6> hexahedron_sides_of_inp = {
    {{0, 1, 2, 3}, {4, 7, 6, 5}, {0, 4, 5, 1}, {1, 5, 6, 2}, {2, 6, 7, 3}, {3, 7, 4, 0}}};
constexpr std::array<Side, 5> prism_sides_of_inp = {
    {{0, 1, 2, -1}, {3, 5, 4, -1}, {0, 3, 4, 1}, {1, 4, 5, 2}, {2, 5, 3, 0}}};
constexpr std::array<Side, 5> pyramid_sides_of_inp = {
    {{0, 1, 2, 3}, {0, 4, 1, -1}, {1, 4, 2, -1}, {2, 4, 3, -1}, {3, 4, 0, -1}}};
constexpr std::array<Side, 3> triangle_sides_of_inp = {{{0, 1, -1, -1}, {1, 2, -1, -1}, {2, 0, -1, -1}}};
constexpr std::array<Side, 4> quadrilateral_sides_of_inp = {
    {{0, 1, -1, -1}, {1, 2, -1, -1}, {2, 3, -1, -1}, {3, 0, -1, -1}}};

std::span<const Side> sides_of(CellKind kind) {
  switch (kind) {
    case CellKind::tetrahedron:
    case CellKind::tetrahedron10:
      return tetrahedron_sides_of_inp;
    case CellKind::hexahedron:
      return hexahedron_sides_of_inp;
    case CellKind::prism:
      return prism_sides_of_inp;
    case CellKind::pyramid:
      return pyramid_sides_of_inp;
    case CellKind::triangle:
    case CellKind::triangle6:
      return triangle_sides_of_inp;
    case CellKind::quadrilateral:
      return quadrilateral_sides_of_inp;
    default:
      return {};
  }
}

}  // namespace

std::optional<InpType> inp_type(std::string_view type) {
  if (type == "STRI65") return InpType{CellKind::triangle6, 6};
  if (type == "B31" || type == "B21" || type == "B31H" || type == "B21H" || type == "B33" || type == "B23")
    return InpType{CellKind::line, 2};
  if (const auto solid = type_of(type, solid_families, solids)) return solid;
  if (const auto plane = type_of(type, plane_families, planes)) return plane;
  if (const auto shell = type_of(type, shell_families, planes)) return shell;
  return type_of(type, line_families, lines);
}

std::span<const int> inp_side(CellKind kind, int side) {
  const std::span<const Side> sides = sides_of(kind);
  if (side < 1 || side > static_cast<int>(sides.size())) return {};
  const Side& corners = sides[static_cast<std::size_t>(side) - 1];
  const std::size_t size = corners[2] < 0 ? 2 : corners[3] < 0 ? 3 : 4;
  return std::span(corners).first(size);
}

}  // namespace resilin
