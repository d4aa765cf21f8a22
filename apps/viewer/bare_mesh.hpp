#pragma once

#include "resilin/io/mesh_file.hpp"

/// Files of meshes and surfaces that a command takes in place of a scene.
namespace resilin::viewer {

/// 3 for cells that fill space and files of surfaces, 2 for cells of a plane; triangles in space are refused
/// with what to do.
int dimension_of(const MeshFile& file);

}  // namespace resilin::viewer
