#pragma once

#include <span>

#include "resilin/mesh/mesh.hpp"

namespace resilin {

/// A node in the middle of an edge and where it is wanted.
struct BentEdge {
  Index middle;
  Vector3 wanted;  ///< [m]
};

/// Moves nodes in the middle of straight edges of quadratic tetrahedra to where they are wanted.
///
/// Where a cell's Jacobian determinant would fall below a fifth of that of the straight cell somewhere, the
/// displacements of its nodes are reduced by steps, at last to nothing. Every cell therefore stays valid.
///
/// @param mesh  its first block holds the cells, straight and of positive volume
/// @return      how many nodes moved less than wanted
Index bend_edges(Mesh& mesh, std::span<const BentEdge> bent);

/// Volume of solid cells, curved sides included [m^3].
double exact_volume(const Mesh& mesh, const CellBlock& cells);

}  // namespace resilin
