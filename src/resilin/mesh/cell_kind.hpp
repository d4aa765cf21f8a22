#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <string_view>

#include "resilin/core/types.hpp"
#include "resilin/element/element.hpp"

namespace resilin {

/// Kinds of cells that files hold. Node order is that of MSH (Gmsh): corners, then the middles of edges.
enum class CellKind {
  point,
  line,
  triangle,
  quadrilateral,
  tetrahedron,
  hexahedron,
  prism,
  pyramid,
  line3,
  triangle6,
  tetrahedron10
};

/// Nodes of the largest kind, and of the largest that can be a facet: what has a place for each node of one
/// has as many. A larger kind does not compile.
inline constexpr std::size_t max_cell_nodes = 10, max_facet_nodes = 6;

/// Nodes of a cell, its corners first.
int num_nodes(CellKind kind);
/// Corners of a cell, without the nodes on its edges.
int num_corners(CellKind kind);
/// Dimension of a cell itself, 1 to 3: 2 for a triangle in space.
int dimension(CellKind kind);
std::string_view name(CellKind kind);      ///< "tetrahedra", plural, for messages
std::string_view singular(CellKind kind);  ///< "tetrahedron"

/// Cells whose edges have a node in the middle.
bool is_second_order(CellKind kind);
CellKind first_order(CellKind kind);   ///< the kind of the corners alone
CellKind second_order(CellKind kind);  ///< with a node on each edge; `kind` itself when there is no such kind

/// Kinds of which a body can be made.
bool is_solid(CellKind kind, int dim);

/// The cells that an element is made of: its nodes and their order are the same.
CellKind cell_kind(const ElementInfo& element);

/// The element without a mean volume whose cells are of this kind; null where there is none.
const ElementInfo* element_of_cells(CellKind kind);

/// Edges by their corners, in the order of the nodes on them. Empty for points, prisms and pyramids.
std::span<const std::array<int, 2>> cell_edges(CellKind kind);

/// A side of a cell by positions in the cell's node list: corners first, outward for a positive volume.
struct CellSide {
  CellKind kind;
  std::array<int, max_facet_nodes> nodes;

  std::span<const int> all() const {
    return std::span(nodes).first(static_cast<std::size_t>(num_nodes(kind)));
  }
  std::span<const int> corners() const {
    return std::span(nodes).first(static_cast<std::size_t>(num_corners(kind)));
  }
};

/// Sides of a tetrahedron: (0,2,1), (0,1,3), (0,3,2), (1,2,3); of a triangle: (0,1), (1,2), (2,0); of a
/// quadrilateral likewise; of a hexahedron: below, above, then around. None for other kinds.
std::span<const CellSide> cell_sides(CellKind kind);

}  // namespace resilin
