#include "bare_mesh.hpp"

#include <algorithm>

#include "resilin/core/error.hpp"

namespace resilin::viewer {

int dimension_of(const MeshFile& file) {
  const bool has_solid_cells = std::ranges::any_of(
      file.mesh.blocks, [](const CellBlock& block) { return dimension(block.kind) == 3; });
  if (file.is_surface || has_solid_cells) return 3;  // a surface gets cells
  const bool is_flat =
      std::ranges::all_of(file.mesh.vertices, [](const Vector3& vertex) { return vertex.z() == 0; });
  if (is_flat && file.mesh.find_solid(2) != nullptr) return 2;
  const std::string& name = file.numbering.file;
  throw InputError(
      name, "a mesh whose cells fill the body, or a file of a surface (STL, PLY, OBJ, VTP, glTF)",
      "triangles in space", "`resilin mesh " + name + " surface.obj --surface` makes such a file of them");
}

}  // namespace resilin::viewer
