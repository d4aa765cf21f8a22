#pragma once

#include <string>

#include "resilin/io/mesh_file.hpp"

namespace resilin::cli {

struct FillOptions {
  int tetrahedra = 5000;    ///< about how many
  std::string mesher;       ///< a name of meshers(); empty: the first that is installed
  double time_limit = 600;  ///< of all attempts together [s]
};

/// Fills a closed surface with tetrahedra by another program, changing the size of the cells until their
/// number is near enough; says on stdout what each attempt gave and how good the result is.
///
/// @throws InputError  when the surface cannot be filled, no such program is installed, or it fails: one line
///                     with the end of what it wrote
Mesh fill_surface(const MeshFile& surface, const FillOptions& options);

}  // namespace resilin::cli
