#pragma once

#include <string>
#include <vector>

#include "resilin/mesh/mesh.hpp"

namespace resilin {

/// Size and limits of a lattice of congruent tetrahedra.
struct LatticeOptions {
  static constexpr int most_cells = 2000000;

  int cells = 4000;  ///< tetrahedra that are wanted; as a rule what comes is within a third of it
};

/// Tetrahedra around a surface, which lies in them with every point.
struct SurfaceLattice {
  Mesh mesh;
  double spacing = 0;  ///< side of the lattice's cubes [m]
  double volume_ratio =
      0;  ///< volume ratio of all cells to what the surface encloses; 0 when it encloses nothing
  std::vector<std::string> remarks;  ///< about the surface, one line each: holes, turned triangles
};

/// The tetrahedra of a body-centred cubic lattice that the surface intersects or encloses.
///
/// All are alike: corners are two neighbouring middles of cubes and the ends of an edge of the face between
/// them; dihedral angles are 60 and 90 degrees. What is inside is told by the winding number of the surface,
/// so that holes, crossings and triangles that are turned around do no harm; where cells would hang together
/// by a vertex or an edge alone, those around it are added. Parts of the surface that come nearer to each
/// other than the spacing grow together. The same input gives the same mesh.
///
/// @param surface  triangles; other cells are passed over
/// @param name     of the file, opens every message
/// @throws InputError  when the surface is an open sheet, encloses no volume or cannot be resolved
SurfaceLattice make_surface_lattice(const Mesh& surface, const std::string& name,
                                    const LatticeOptions& options = {});

}  // namespace resilin
