#pragma once

#include <array>
#include <utility>
#include <vector>

#include "resilin/mesh/mesh.hpp"

namespace resilin {

/// Signed volume [m^3] of each solid cell, or signed area [m^2] in the x-y plane; negative when inverted. Of
/// second-order cells that of the corners.
std::vector<double> signed_volumes(const Mesh& mesh, const CellBlock& block);

/// Half the product of two sides of each triangle in space, by corners [m^2].
std::vector<Vector3> triangle_area_vectors(const Mesh& mesh, const CellBlock& block);

/// Area [m^2] of each triangle in space, by corners.
std::vector<double> triangle_areas(const Mesh& mesh, const CellBlock& block);

/// Volume that rounding alone may give a flat cell: a volume below it cannot be told from zero. 16 eps
/// L^(d-1) max(L, |coordinate|), with L the longest edge.
double volume_round_off(const Mesh& mesh, const CellBlock& block, Index cell);

/// A cell that is inverted somewhere although its volume is not zero.
struct FoldedCell {
  Index cell;
  double jacobian;  ///< det dX/dxi at `xi`, zero or negative, once the cell is oriented by its volume
  Vector3 xi;
};

/// Cells by the sign of their volume; cells that are in no list are sound. Each list ascends.
struct CellSigns {
  std::vector<Index> inverted;
  std::vector<Index> flat;        ///< volume zero up to rounding, or two equal nodes
  std::vector<Index> not_finite;  ///< volume overflows or a coordinate is not a number
  /// Second-order cells, quadrilaterals and hexahedra whose Jacobian is not positive everywhere
  /// (element/jacobian_bound.hpp).
  std::vector<FoldedCell> folded;
};
/// Finds the cells of a block whose volume is not positive, or whose Jacobian is not positive everywhere.
CellSigns cell_signs(const Mesh& mesh, const CellBlock& block);

/// Pairs (first, later) of cells with the same set of nodes.
std::vector<std::pair<Index, Index>> duplicate_cells(const CellBlock& block);

/// Pairs (first, later) of vertices with exactly the same coordinates.
std::vector<std::pair<Index, Index>> duplicate_vertices(const Mesh& mesh);

/// Edges that three or more triangles share, smaller vertex first.
std::vector<std::array<Index, 2>> nonmanifold_edges(const CellBlock& triangles);

/// Edges that one triangle alone has, smaller vertex first, sorted: where the surface is open. Vertices at
/// the same place count as one.
std::vector<std::array<Index, 2>> open_edges(const Mesh& mesh, const CellBlock& triangles);

/// Pairs of cells that lie on the same side of a side that they share, and so overlap; smaller cell first,
/// sorted. Cells have volumes, of either sign.
std::vector<std::array<Index, 2>> cells_on_one_side(const Mesh& mesh, const CellBlock& block);

/// The smallest of the six angles between the sides of each tetrahedron [degrees]; about 70.5 when it is
/// regular, near 0 for slivers.
std::vector<double> smallest_dihedral_angles(const Mesh& mesh, const CellBlock& tetrahedra);

/// Inverted or not, the shape of a tetrahedron: 6 sqrt(2) V / (root mean square edge)^3; 1 when regular, 0
/// when flat, negative when inverted. In 2D 4/sqrt(3) A / (mean square edge). Source: Parthasarathy, Graichen
/// & Hathaway 1994, "A comparison of tetrahedron quality measures". Of quadrilaterals and hexahedra the least
/// Jacobian at a corner, divided by the lengths of its edges (Knupp 2000): 1 for a rectangle or a box.
std::vector<double> shape_qualities(const Mesh& mesh, const CellBlock& block);

}  // namespace resilin
