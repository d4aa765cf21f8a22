#pragma once

#include <array>
#include <vector>

#include "resilin/mesh/mesh.hpp"

namespace resilin {

/// A mesh of second order and where its new nodes come from.
struct SecondOrderMesh {
  Mesh mesh;
  std::vector<std::array<Index, 2>> ends;  ///< ends of the edge of each node that was added, in their order
};

/// Gives every edge of lines, triangles and tetrahedra a node in its middle, after the mesh's own vertices,
/// in the order of the edges' sorted ends. Cells of second order keep their nodes, and first-order facets on
/// them take the nodes that are there. Groups get the new nodes of their cells; a group of vertices alone
/// gets those of `middles_between`. Linear in the number of cells up to sorting.
SecondOrderMesh second_order(const Mesh& mesh);

/// Nodes in the middle of edges of second-order solid cells whose both ends are in a set; sorted. An edge
/// through the inside of the body whose ends both lie on its surface does not count, so that a set of surface
/// vertices never takes hold of a node inside.
std::vector<Index> middles_between(const CellBlock& cells, const std::vector<bool>& is_in_set);

}  // namespace resilin
