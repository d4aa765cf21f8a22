#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "resilin/mesh/mesh.hpp"
#include "subprocess.hpp"

namespace resilin::cli {

/// A program, not part of Resilin, that fills a closed surface with tetrahedra.
struct Mesher {
  std::string name;
  std::string how_to_install;
  bool needs_closed_surface;
  /// Where it is; empty when it is not installed. @param folder  for what looking for it writes
  std::optional<std::filesystem::path> (*find)(const std::filesystem::path& folder);
  /// Makes tetrahedra with edges of about `size` [m] inside `surface.obj` of the folder.
  Subprocess (*run)(const std::filesystem::path& program, const std::filesystem::path& folder, double size,
                    double extent, double seconds);
  std::string result;  ///< the file in the folder that it makes
};

/// All of them, the preferred one first.
const std::vector<Mesher>& meshers();

}  // namespace resilin::cli
