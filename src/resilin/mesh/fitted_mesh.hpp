#pragma once

#include <string>
#include <vector>

#include "resilin/mesh/mesh.hpp"

namespace resilin {

/// Size and limits of a mesh that ends at its surface.
struct FittedMeshOptions {
  static constexpr int most_cells = 2000000;

  int cells = 4000;  ///< tetrahedra that are wanted; as a rule what comes is within a tenth of it
  double size = 0;   ///< edge length of the cells, in place of their number [m]; 0 where that is given
  /// Least edge length of cells where the surface is curved or walls are thin [m]; 0: two fifths of the
  /// others where it is curved.
  double min_size = 0;
  bool is_quadratic = false;  ///< cells with nodes in the middles of their edges, on the surface too
};

/// Tetrahedra whose boundary follows a surface.
struct FittedMesh {
  Mesh mesh;
  double cell_size = 0;              ///< edge length of the cells [m]
  double volume = 0;                 ///< volume inside the surface [m^3]
  double volume_ratio = 0;           ///< volume ratio of all cells to `volume`; 0 when it encloses nothing
  std::vector<std::string> remarks;  ///< about the surface, one line each: holes, turned triangles
};

/// Fills a surface with tetrahedra that end at it.
///
/// Points are spread over sharp edges, over the surface, and inside on a body-centred cubic lattice. Their
/// Delaunay tetrahedra whose middles lie inside, by the winding number of the surface, are the cells. Points
/// are added where the boundary of the cells is far from the surface, by the thickness of walls too, so that
/// thin walls keep one layer of flat cells at least. Then points are moved and edges exchanged until the
/// dihedral angles are good. The same input gives the same mesh for any number of threads.
///
/// Sources: Boissonnat & Oudot 2005, "Provably good sampling and meshing of surfaces" (points of the surface
/// make its facets); Labelle & Shewchuk 2007, "Isosurface stuffing" (the lattice inside).
///
/// @param surface  triangles; other cells are passed over
/// @param name     of the file, opens every message
/// @throws InputError  when the surface is an open sheet, encloses no volume or cannot be resolved
FittedMesh make_fitted_mesh(const Mesh& surface, const std::string& name,
                            const FittedMeshOptions& options = {});

}  // namespace resilin
