#pragma once

#include <string>
#include <vector>

#include "resilin/mesh/mesh.hpp"
#include "resilin/mesh/numbering.hpp"
#include "resilin/mesh/quality.hpp"

namespace resilin {

/// One thing that is wrong or odd about a mesh.
struct MeshIssue {
  std::string place;    ///< "beam.msh: element 2"
  std::string problem;  ///< "its volume is zero ..."

  std::string text() const { return place + ": " + problem; }  ///< one line
};

/// Findings about a mesh: errors prevent a simulation, warnings do not.
struct MeshReport {
  std::vector<MeshIssue> errors;
  std::vector<MeshIssue> warnings;

  /// @throws InputError with the first error, if there is one
  void require_no_errors() const;
};

/// The fault of an inverted second-order cell and its cure: which node in the middle of an edge stands too
/// far off, or that the corners are in another order than that of MSH.
std::string fold_text(const Mesh& mesh, const CellBlock& block, const FoldedCell& folded,
                      const Numbering& numbering);

/// Examines a mesh that is to be a solid of `dimension` 2 (triangles, quadrilaterals) or 3 (tetrahedra,
/// hexahedra), of first or second order.
///
/// Errors: no cells of the dimension, cells of several kinds or of one that cannot be simulated, nodes that
/// do not exist or are missing in the middle of edges, coordinates that are not finite (or leave the plane in
/// 2D), flat cells, cells that are inverted somewhere, cells given twice, more than two cells at one side or
/// two on the same side of it. Warnings: inverted cells (to be mended by `reorient`), vertices of no cell,
/// vertices at the same place, several components, such that share space, joints at a single vertex or edge.
MeshReport check_mesh(const Mesh& mesh, int dimension, const Numbering& numbering = {});

/// Examines a surface of triangles (skin, collision surface). Errors as above; flat triangles, edges of more
/// than two triangles or of one alone, duplicates and unused vertices are warnings.
MeshReport check_surface(const Mesh& mesh, const Numbering& numbering = {});

}  // namespace resilin
