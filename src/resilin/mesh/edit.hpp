#pragma once

#include <span>
#include <vector>

#include "resilin/mesh/mesh.hpp"

namespace resilin {

/// Exchanges nodes of a cell so that its volume changes sign and its shape stays: two corners of a simplex,
/// with the nodes on their edges; the lower and the upper corners of a hexahedron.
void turn_around(CellKind kind, std::span<Index> nodes);

/// Turns every inverted solid cell around. @return the cells of the block of `kind` that were inverted
std::vector<Index> reorient(Mesh& mesh, CellKind kind);

/// Replaces second-order cells by the cells of their corners; the nodes between corners stay as vertices
/// until `remove_unused_nodes`. A kind that is there in both orders is left alone. @return true when there
/// were any
bool to_first_order(Mesh& mesh);

/// Drops vertices of no cell. @return new number of each old vertex, -1 for a dropped one
std::vector<Index> remove_unused_nodes(Mesh& mesh);

/// Joins vertices at exactly the same place to the first of them, then drops the others.
/// @return new number of each old vertex (unused ones are dropped too: -1)
std::vector<Index> merge_duplicate_vertices(Mesh& mesh);

/// The boundary of the solid cells as triangles, outward; of a plane mesh its cells themselves. Second-order
/// cells are taken by their corners, quadrilaterals are cut in two.
struct Surface {
  Mesh mesh;
  std::vector<Index> volume_vertices;  ///< number in the given mesh of each vertex
};
/// Boundary facets of all cells, seen from outside anticlockwise, with the vertices that they use.
Surface extract_surface(const Mesh& mesh);

/// X -> A X + b for every vertex. A reflection (det A < 0) inverts the cells.
void transform(Mesh& mesh, const Matrix<3>& A, const Vector3& b);

/// Rotation by `degrees` about `axis` (any length but zero) through the origin, right-handed.
Matrix<3> rotation_matrix(const Vector3& axis, double degrees);

/// Smallest box of the vertices that cells use (a stray vertex does not count); the origin when there are
/// none.
struct BoundingBox {
  Vector3 min = Vector3::Zero();
  Vector3 max = Vector3::Zero();
};
/// Box of all vertices along the axes [m], those without a cell included.
BoundingBox bounding_box(const Mesh& mesh);

}  // namespace resilin
