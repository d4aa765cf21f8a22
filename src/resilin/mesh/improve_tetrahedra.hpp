#pragma once

#include <array>
#include <functional>
#include <vector>

#include "resilin/core/types.hpp"

namespace resilin {

/// Where vertices may go while tetrahedra are improved.
struct VertexGuide {
  /// Moves a wanted position of a vertex to an allowed one nearby; false where the vertex stays.
  std::function<bool(Index vertex, Vector3& position)> project;
  /// Whether a triangle may be a side of the boundary.
  std::function<bool(Index a, Index b, Index c)> may_be_side;
  /// Whether the boundary has to keep the edge between two vertices.
  std::function<bool(Index a, Index b)> is_kept;
};

/// Tetrahedra while their shapes are improved.
struct TetrahedronSet {
  std::vector<Vector3> positions;           ///< positions of the vertices [m]
  std::vector<std::array<Index, 4>> cells;  ///< in positive orientation, but for flat ones
};

/// Least sine of a tetrahedron's six dihedral angles; negative when it is inverted, 0 when flat. A regular
/// tetrahedron has 0.943.
double least_sine(const std::array<Vector3, 4>& corners);

/// Moves vertices and exchanges edges and faces so that the worst dihedral angles improve.
///
/// Each step raises the least sine of the cells that it changes (Freitag & Ollivier-Gooch 1997; edges are
/// removed by Klincsek's dynamic programming as in Shewchuk 2002, "Two discrete optimization algorithms for
/// the topological improvement of tetrahedral meshes").
///
/// @param wanted  sine up to which a cell is good enough
/// @return        the least sine of all cells
double improve_tetrahedra(TetrahedronSet& set, const VertexGuide& guide, double wanted, int passes);

}  // namespace resilin
