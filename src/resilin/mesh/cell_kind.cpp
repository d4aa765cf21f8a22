#include "resilin/mesh/cell_kind.hpp"

#include <algorithm>
#include <utility>

#include "resilin/element/catalog.hpp"

namespace resilin {
namespace {

struct KindFacts {
  int num_nodes;
  int num_corners;
  int dimension;
  std::string_view name;
  std::string_view singular;
  CellKind first_order;
  CellKind second_order;
};

/// Does not compile for a kind that is larger than what holds the nodes of a cell.
consteval KindFacts checked(const KindFacts& facts) {
  if (std::cmp_greater(facts.num_nodes, max_cell_nodes)) throw "max_cell_nodes is smaller than this kind";
  if (facts.dimension < 3 && std::cmp_greater(facts.num_nodes, max_facet_nodes))
    throw "max_facet_nodes is smaller than this kind";
  return facts;
}

constexpr KindFacts facts(CellKind kind) {
  using enum CellKind;
  switch (kind) {
    case point:
      return checked({1, 1, 0, "points", "point", point, point});
    case line:
      return checked({2, 2, 1, "lines", "line", line, line3});
    case triangle:
      return checked({3, 3, 2, "triangles", "triangle", triangle, triangle6});
    case quadrilateral:
      return checked({4, 4, 2, "quadrilaterals", "quadrilateral", quadrilateral, quadrilateral});
    case tetrahedron:
      return checked({4, 4, 3, "tetrahedra", "tetrahedron", tetrahedron, tetrahedron10});
    case hexahedron:
      return checked({8, 8, 3, "hexahedra", "hexahedron", hexahedron, hexahedron});
    case prism:
      return checked({6, 6, 3, "prisms", "prism", prism, prism});
    case pyramid:
      return checked({5, 5, 3, "pyramids", "pyramid", pyramid, pyramid});
    case line3:
      return checked({3, 2, 1, "second-order lines", "second-order line", line, line3});
    case triangle6:
      return checked({6, 3, 2, "second-order triangles", "second-order triangle", triangle, triangle6});
    case tetrahedron10:
      return checked(
          {10, 4, 3, "second-order tetrahedra", "second-order tetrahedron", tetrahedron, tetrahedron10});
  }
  return checked({1, 1, 0, "points", "point", point, point});
}

constexpr std::array<std::array<int, 2>, 4> plane_edges = {{{0, 1}, {1, 2}, {2, 3}, {3, 0}}};
constexpr std::array<std::array<int, 2>, 3> triangle_edges = {{{0, 1}, {1, 2}, {2, 0}}};
constexpr std::array<std::array<int, 2>, 6> tetrahedron_edges = {
    {{0, 1}, {1, 2}, {2, 0}, {3, 0}, {2, 3}, {1, 3}}};
constexpr std::array<std::array<int, 2>, 12> hexahedron_edges = {
    {{0, 1}, {0, 3}, {0, 4}, {1, 2}, {1, 5}, {2, 3}, {2, 6}, {3, 7}, {4, 5}, {4, 7}, {5, 6}, {6, 7}}};

constexpr std::array<CellSide, 3> triangle_sides = {
    {{CellKind::line, {0, 1}}, {CellKind::line, {1, 2}}, {CellKind::line, {2, 0}}}};
constexpr std::array<CellSide, 3> triangle6_sides = {
    {{CellKind::line3, {0, 1, 3}}, {CellKind::line3, {1, 2, 4}}, {CellKind::line3, {2, 0, 5}}}};
constexpr std::array<CellSide, 4> quadrilateral_sides = {
    {{CellKind::line, {0, 1}}, {CellKind::line, {1, 2}}, {CellKind::line, {2, 3}}, {CellKind::line, {3, 0}}}};
constexpr std::array<CellSide, 4> tetrahedron_sides = {{{CellKind::triangle, {0, 2, 1}},
                                                        {CellKind::triangle, {0, 1, 3}},
                                                        {CellKind::triangle, {0, 3, 2}},
                                                        {CellKind::triangle, {1, 2, 3}}}};
constexpr std::array<CellSide, 4> tetrahedron10_sides = {{{CellKind::triangle6, {0, 2, 1, 6, 5, 4}},
                                                          {CellKind::triangle6, {0, 1, 3, 4, 9, 7}},
                                                          {CellKind::triangle6, {0, 3, 2, 7, 8, 6}},
                                                          {CellKind::triangle6, {1, 2, 3, 5, 8, 9}}}};
constexpr std::array<CellSide, 6> hexahedron_sides = {{{CellKind::quadrilateral, {0, 3, 2, 1}},
                                                       {CellKind::quadrilateral, {4, 5, 6, 7}},
                                                       {CellKind::quadrilateral, {0, 1, 5, 4}},
                                                       {CellKind::quadrilateral, {1, 2, 6, 5}},
                                                       {CellKind::quadrilateral, {2, 3, 7, 6}},
                                                       {CellKind::quadrilateral, {3, 0, 4, 7}}}};

/// The boundary of a block of cells is one block of facets (mesh/topology.hpp).
constexpr bool are_of_one_kind(std::span<const CellSide> sides) {
  return std::ranges::all_of(sides, [&](const CellSide& side) { return side.kind == sides[0].kind; });
}
static_assert(are_of_one_kind(triangle_sides) && are_of_one_kind(triangle6_sides) &&
              are_of_one_kind(quadrilateral_sides) && are_of_one_kind(tetrahedron_sides) &&
              are_of_one_kind(tetrahedron10_sides) && are_of_one_kind(hexahedron_sides));

constexpr CellKind kind_of(CellShape shape, int degree) {
  switch (shape) {
    case CellShape::triangle:
      return degree == 2 ? CellKind::triangle6 : CellKind::triangle;
    case CellShape::quadrilateral:
      return CellKind::quadrilateral;
    case CellShape::tetrahedron:
      return degree == 2 ? CellKind::tetrahedron10 : CellKind::tetrahedron;
    case CellShape::hexahedron:
      break;
  }
  return CellKind::hexahedron;
}

template <class... Element>
constexpr bool all_have_cells(ElementList<Element...>) {
  return ((facts(kind_of(Element::shape, Element::degree)).num_nodes == Element::num_nodes) && ...);
}
static_assert(all_have_cells(Elements{}), "an element has as many nodes as the kind of its cells");

}  // namespace

int num_nodes(CellKind kind) { return facts(kind).num_nodes; }
int num_corners(CellKind kind) { return facts(kind).num_corners; }
int dimension(CellKind kind) { return facts(kind).dimension; }
std::string_view name(CellKind kind) { return facts(kind).name; }
std::string_view singular(CellKind kind) { return facts(kind).singular; }
bool is_second_order(CellKind kind) { return num_nodes(kind) > num_corners(kind); }
CellKind first_order(CellKind kind) { return facts(kind).first_order; }
CellKind second_order(CellKind kind) { return facts(kind).second_order; }

bool is_solid(CellKind kind, int dim) { return dimension(kind) == dim && !cell_sides(kind).empty(); }

CellKind cell_kind(const ElementInfo& element) { return kind_of(element.shape, element.degree); }

const ElementInfo* element_of_cells(CellKind kind) {
  static const std::vector<const ElementInfo*> all = elements();
  for (const ElementInfo* element : all)
    if (cell_kind(*element) == kind && !element->has_mean_volume) return element;
  return nullptr;
}

std::span<const std::array<int, 2>> cell_edges(CellKind kind) {
  switch (first_order(kind)) {
    case CellKind::line:
      return std::span(plane_edges).first(1);
    case CellKind::triangle:
      return triangle_edges;
    case CellKind::quadrilateral:
      return plane_edges;
    case CellKind::tetrahedron:
      return tetrahedron_edges;
    case CellKind::hexahedron:
      return hexahedron_edges;
    default:
      return {};
  }
}

std::span<const CellSide> cell_sides(CellKind kind) {
  switch (kind) {
    case CellKind::triangle:
      return triangle_sides;
    case CellKind::triangle6:
      return triangle6_sides;
    case CellKind::quadrilateral:
      return quadrilateral_sides;
    case CellKind::tetrahedron:
      return tetrahedron_sides;
    case CellKind::tetrahedron10:
      return tetrahedron10_sides;
    case CellKind::hexahedron:
      return hexahedron_sides;
    default:
      return {};
  }
}

}  // namespace resilin
