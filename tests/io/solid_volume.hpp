#pragma once

#include <filesystem>
#include <numeric>
#include <string>

#include "resilin/mesh/mesh.hpp"
#include "resilin/mesh/quality.hpp"
#include "shared_data.hpp"

namespace resilin::testing {

inline std::filesystem::path mesh_file(const std::string& name) {
  return source_folder() / "tests" / "data" / "meshes" / name;
}

/// Sum of the signed volumes of the cells of a solid in 3D.
inline double solid_volume(const Mesh& mesh) {
  const auto volumes = signed_volumes(mesh, *mesh.find_solid(3));
  return std::accumulate(volumes.begin(), volumes.end(), 0.0);
}

}  // namespace resilin::testing
