#pragma once

#include "resilin/mesh/mesh.hpp"

namespace resilin {

/// Gives cells that fill a surface its groups of triangles.
///
/// A facet of the cells belongs to the group of the triangle that is nearest to its centroid; a group gets
/// the vertices of its facets. Where the triangles of a group are closed by themselves, such as one solid of
/// several in an STL file, it gets the cells whose centroids they enclose, too.
///
/// @param cells  its groups are replaced
void carry_groups(const Mesh& surface, Mesh& cells);

}  // namespace resilin
