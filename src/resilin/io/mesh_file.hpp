#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "resilin/mesh/check.hpp"
#include "resilin/mesh/mesh.hpp"
#include "resilin/mesh/numbering.hpp"

namespace resilin {

/// A mesh as a file gives it: nothing re-oriented, joined (but the corners of STL, which has no vertices) or
/// left out.
struct MeshFile {
  Mesh mesh;
  Numbering numbering;                ///< numbers of vertices and cells in the file
  std::string format;                 ///< "MSH 4.1", "Medit", ...
  std::vector<std::string> warnings;  ///< one line each
  bool is_surface = false;            ///< for a format that holds surfaces alone, or triangles in space
};

/// Reads a mesh; the format is told by the first bytes, else by the extension (see io/catalog.hpp).
///
/// @throws InputError  naming file and line or element, when the content is wrong
/// @throws FileError   when the file cannot be opened
MeshFile read_mesh(const std::filesystem::path& path);

/// Opens a file beside the mesh for the formats that use several: its name ("cow.ele", "textures/cow.bin"),
/// relative to the folder of the mesh -> its bytes.
using Companion = std::function<std::string(const std::string& name)>;

/// As `read_mesh`, from bytes in memory. `name` opens every message and its extension helps to tell the
/// format.
MeshFile read_mesh_from_memory(const std::string& name, std::string_view bytes,
                               const Companion& companion = {});

/// Reads, checks and prepares a solid for simulation: cells of several kinds are cut into simplices (see
/// cut_into_simplices), inverted ones are re-oriented, and `warnings` tells of it and of everything else that
/// is odd (see check_mesh).
///
/// @param dimension 3: tetrahedra or hexahedra, 2: triangles or quadrilaterals
/// @throws InputError for the first error of check_mesh
MeshFile read_solid_mesh(const std::filesystem::path& path, int dimension);

/// The second half of `read_solid_mesh`, for a mesh from elsewhere.
void prepare_solid_mesh(MeshFile& file, int dimension);

/// Triangles of first order in place of all facets of a surface.
void prepare_surface(MeshFile& file);

/// Reduces second-order cells to their corners, with a warning when there are any.
void use_corners_only(MeshFile& file);

/// Findings about a file of which only the name is known: one of a surface format (OBJ, STL, ...)
/// is examined as a surface, cells of space as a 3D solid, cells in the plane z = 0 as a 2D one, triangles in
/// space as a surface.
MeshReport check_mesh_file(const MeshFile& file);

/// Writes a mesh in the format of the extension: .msh (MSH 4.1), .vtu, .mesh (Medit), .obj (surface).
/// The file is written beside and renamed.
void write_mesh(const std::filesystem::path& path, const Mesh& mesh);

}  // namespace resilin
