#pragma once

#include <string>
#include <vector>

#include "resilin/mesh/mesh.hpp"
#include "resilin/mesh/numbering.hpp"

namespace resilin {

/// One thing that is wrong or odd about a mesh.
struct MeshIssue {
  std::string place;    ///< "beam.msh: element 2"
  std::string problem;  ///< "its volume is zero ..."

  std::string text() const { return place + ": " + problem; }  ///< one line
};

/// What is wrong with a mesh (errors: it cannot be simulated) and what is odd (warnings).
struct MeshReport {
  std::vector<MeshIssue> errors;
  std::vector<MeshIssue> warnings;

  /// @throws InputError with the first error, if there is one
  void require_no_errors() const;
};

/// Examines a mesh that is to be a solid of `dimension` 2 (triangles) or 3 (tetrahedra).
///
/// Errors: no cells of the dimension, cells of a kind that cannot be simulated, nodes that do not exist,
/// coordinates that are not finite (or leave the plane in 2D), flat cells, cells given twice, more than two
/// cells at one side. Warnings: inverted cells (to be mended by `reorient`), vertices of no cell, vertices at
/// the same place, several components, joints at a single vertex or edge.
MeshReport check_mesh(const Mesh& mesh, int dimension, const Numbering& numbering = {});

/// Examines a surface of triangles (skin, collision surface). Errors as above; flat triangles, edges of more
/// than two triangles, duplicates and unused vertices are warnings.
MeshReport check_surface(const Mesh& mesh, const Numbering& numbering = {});

}  // namespace resilin
