#include "resilin/results/mesh_volume_ratio.hpp"

#include "resilin/core/error.hpp"
#include "resilin/mesh/curved_cells.hpp"
#include "resilin/mesh/solid_surface.hpp"
#include "resilin/mesh/surface_places.hpp"
#include "resilin/world/skin.hpp"

namespace resilin {
namespace {

Mesh mesh_of(const VectorX& positions, CellBlock cells) {
  Mesh mesh;
  for (Eigen::Index i = 0; i + 2 < positions.size(); i += 3)
    mesh.vertices.emplace_back(positions.segment<3>(i));
  mesh.blocks = {std::move(cells)};
  return mesh;
}

}  // namespace

std::optional<double> mesh_volume_ratio(const World& world, const Body& body) {
  if (!body.skin || body.rigid || world.dimension != 3 || !world.share.is_whole()) return std::nullopt;
  try {
    const SolidSurface surface =
        make_solid_surface(mesh_of(body.skin->rest_positions, body.skin->facets), body.skin->name);
    if (surface.num_open_edges > 0) return std::nullopt;
    const double enclosed = SurfacePlaces(surface).volume();
    const Mesh mesh = mesh_of(world.rest_positions, {body.cell_kind, {body.cells.begin(), body.cells.end()}});
    if (!(enclosed > 0)) return std::nullopt;
    return exact_volume(mesh, mesh.blocks[0]) / enclosed;
  } catch (const InputError&) {
    return std::nullopt;  // a skin without an area
  }
}

}  // namespace resilin
