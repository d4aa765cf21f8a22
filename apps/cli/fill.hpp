#pragma once

#include <string>
#include <vector>

#include "resilin/io/mesh_file.hpp"

namespace resilin::cli {

struct FillOptions {
  int tetrahedra = 5000;          ///< about how many
  std::string mesher = "fitted";  ///< a name of all_meshers()
  double time_limit = 600;        ///< time limit of all attempts of another program together [s]
};

/// The meshers of Resilin, then those that are programs of their own (meshers()).
std::vector<std::string> all_meshers();

/// Fills a surface with tetrahedra. Another program is called with other sizes of the cells until their
/// number is near enough. Says on stdout what each attempt gave and how good the result is.
///
/// @throws InputError  when the surface cannot be filled, no such program is installed, or it fails: one line
///                     with the end of what it wrote
Mesh fill_surface(const MeshFile& surface, const FillOptions& options);

}  // namespace resilin::cli
