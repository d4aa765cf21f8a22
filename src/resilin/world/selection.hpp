#pragma once

#include <functional>
#include <string>
#include <vector>

#include "resilin/world/world.hpp"

namespace resilin {

/// A group of a mesh. Throws InputError beginning with `place`, with the names of those there are.
const Group& find_group(const Mesh& mesh, const std::string& name, const std::string& place);

/// Whether a box, plane or sphere holds a point; anything does in other selections.
/// @param where   kept by reference
/// @param extent  of the body [m]
std::function<bool(const Vector3&)> place_test(const Where& where, int dim, double extent,
                                               const std::string& place);

/// Nodes of a body (numbers of its mesh, ascending) that a `where` means, in the placed rest shape.
///
/// Places (box, plane, sphere) are tested at each node, also those in the middle of edges. A group means the
/// nodes of its cells; listed vertices mean themselves and the nodes of `middles_between`. A selection of
/// facets means their nodes.
/// Only nodes that a cell uses are selected. Throws InputError beginning with `place` when the group is
/// unknown (and lists those there are), a vertex number is out of range, or nothing is selected.
/// @param mesh  of the body with all nodes of its element
std::vector<Index> select_vertices(const Where& where, const Mesh& mesh, const Body& body,
                                   const VectorX& rest_positions, int dim, const std::string& place);

/// A flag for each facet of `boundary` of a body's cells: whether a selection means it. Those that mean no
/// facets mean each one whose nodes are all selected.
std::vector<bool> meant_facets(const Where& where, const std::vector<Index>& selected_vertices,
                               const Body& body, const VectorX& rest_positions, int dim,
                               const std::string& place);

/// The surface facets of a body that a selection means, outward, in the world's numbering. Throws InputError
/// when there is none.
CellBlock select_facets(const Where& where, const std::vector<Index>& selected_vertices, const Body& body,
                        const VectorX& rest_positions, int dim, const std::string& place);

/// The surface facets of a body whose nodes are all among these, in the world's numbering; maybe none.
CellBlock facets_between(const std::vector<Index>& selected_vertices, const Body& body);

/// Nodes, in the world's numbering, of the cells whose nodes are all selected.
std::vector<Index> select_cells(const std::vector<Index>& selected_vertices, const Body& body);

}  // namespace resilin
