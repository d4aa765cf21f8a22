#pragma once

#include <array>
#include <functional>
#include <span>
#include <vector>

#include "resilin/mesh/mesh.hpp"

namespace resilin {

/// Side number `local` of cell `cell`, in the order of `cell_sides`: outward when the cell has positive
/// volume (area).
struct Facet {
  Index cell;
  int local;
};

/// Corners of a side; -1 after the last one.
std::array<Index, 4> facet_corners(const CellBlock& block, Facet facet);

/// Sides of the cells that belong to one cell only.
struct Boundary {
  CellBlock facets;           ///< outward for cells of positive volume; of second order when the cells are
  std::vector<Facet> owners;  ///< the side that each facet is; ordered by cell, then by side
};

/// The boundary of a block of solid cells. Linear in the number of cells.
Boundary boundary(const CellBlock& block);

/// The visible surface of solid cells: the boundary of those that fill space; those of a plane are seen
/// themselves (`local` of their owners is -1).
Boundary visible_facets(const CellBlock& block);

/// Calls `visit` once for every distinct side (set of nodes) with all its uses, in a fixed order.
void visit_facets(const CellBlock& block, const std::function<void(std::span<const Facet>)>& visit);

/// Every edge of the cells once, by its corners, smaller node first, sorted.
std::vector<std::array<Index, 2>> edges(const CellBlock& block);

/// Cells that hang together. Components are numbered in the order of their first cells.
struct Components {
  Index count = 0;
  std::vector<Index> of_cell;
  std::vector<Index> of_vertex;  ///< -1 for a vertex of no cell
};

/// Components of cells that share a vertex, of blocks of any kind.
Components connected_components(const CellBlock& block, Index num_vertices);

/// Where cells meet that do not hang together around the place: at a vertex through which alone they do (a
/// bow tie: no other vertex is common to both sides), or along an edge of cells in space without a common
/// side.
struct Pinches {
  std::vector<Index> vertices;              ///< rising
  std::vector<std::array<Index, 2>> edges;  ///< smaller vertex first, rising
};
/// Vertices, and in 3D edges, at which parts of a body hang together alone.
Pinches find_pinches(const CellBlock& block, Index num_vertices);

/// vertex_is_used[v] is true when a cell of the block has node v.
std::vector<bool> used_vertices(const CellBlock& block, Index num_vertices);

}  // namespace resilin
