#pragma once

#include <string>

#include "resilin/mesh/mesh.hpp"
#include "resilin/mesh/numbering.hpp"

namespace resilin {

/// Whether cells of this dimension are of kinds, or beside others, of which no body can be made.
bool needs_cuts(const Mesh& mesh, int dimension);

/// Cuts all cells of this dimension into tetrahedra (2D: triangles) where no body can be made of them as they
/// are: prisms, pyramids, hexahedra beside tetrahedra or with corners at one vertex, quadrilaterals beside
/// triangles. Second-order cells among them are taken by their corners.
///
/// A cell is cut by the planes through its vertex of the least number, and a side by the diagonal through
/// its own, so that neighbours agree. Groups, fields and numbers of cells go to the pieces. Source: Dompierre
/// et al. 1999, "How to subdivide pyramids, prisms, and hexahedra into tetrahedra".
///
/// @return "2 prisms and 1 hexahedra are cut into 12 tetrahedra"; empty when nothing was cut
std::string cut_into_simplices(Mesh& mesh, int dimension, Numbering& numbering);

/// Cuts the quadrilaterals of a surface. @return as above
std::string cut_into_triangles(Mesh& mesh, Numbering& numbering);

}  // namespace resilin
