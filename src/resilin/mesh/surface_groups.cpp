#include "resilin/mesh/surface_groups.hpp"

#include <algorithm>
#include <array>
#include <vector>

#include "resilin/mesh/box_tree.hpp"
#include "resilin/mesh/closest_point.hpp"
#include "resilin/mesh/solid_surface.hpp"
#include "resilin/mesh/topology.hpp"
#include "resilin/mesh/winding_number.hpp"

namespace resilin {
namespace {

Vector3 centroid_of(const Mesh& mesh, std::span<const Index> corners) {
  Vector3 sum = Vector3::Zero();
  for (const Index corner : corners) sum += mesh.vertices[static_cast<std::size_t>(corner)];
  return sum / static_cast<double>(corners.size());
}

/// For each facet of the cells, the triangle that is nearest to its centroid.
std::vector<Index> nearest_triangles(const Mesh& surface, const CellBlock& triangles, const Mesh& cells,
                                     const CellBlock& facets) {
  std::vector<Box> boxes(static_cast<std::size_t>(triangles.num_cells()));
  for (Index t = 0; t < triangles.num_cells(); ++t)
    for (const Index corner : triangles.cell(t))
      boxes[static_cast<std::size_t>(t)].add(surface.vertices[static_cast<std::size_t>(corner)]);
  const BoxTree tree(boxes, static_cast<std::size_t>(facets.num_cells()));
  std::vector<Index> nearest;
  for (Index f = 0; f < facets.num_cells(); ++f) {
    const Vector3 point = centroid_of(cells, facets.cell(f));
    nearest.push_back(tree.nearest(point, [&](Index t) {
      const auto corner = [&](std::size_t k) -> const Vector3& {
        return surface.vertices[static_cast<std::size_t>(triangles.cell(t)[k])];
      };
      const auto shares = closest_on_triangle(point, corner(0), corner(1), corner(2));
      return (shares[0] * corner(0) + shares[1] * corner(1) + shares[2] * corner(2) - point).squaredNorm();
    }));
  }
  return nearest;
}

}  // namespace

void carry_groups(const Mesh& surface, Mesh& cells) {
  cells.groups.clear();
  const CellBlock* triangles = surface.find_block(CellKind::triangle);
  const CellBlock* solid = cells.find_solid(3);
  if (surface.groups.empty() || triangles == nullptr || solid == nullptr) return;
  const auto solid_block = static_cast<std::size_t>(solid - cells.blocks.data());
  const auto block = static_cast<std::size_t>(triangles - surface.blocks.data());
  const CellBlock facets = boundary(*solid).facets;
  const std::vector<Index> nearest = nearest_triangles(surface, *triangles, cells, facets);
  for (const Group& given : surface.groups) {
    if (given.cells.size() <= block || given.cells[block].empty()) continue;
    std::vector<bool> has(static_cast<std::size_t>(triangles->num_cells()), false);
    CellBlock own{.kind = CellKind::triangle, .nodes = {}};
    for (const Index t : given.cells[block]) {
      has[static_cast<std::size_t>(t)] = true;
      const std::span<const Index> corners = triangles->cell(t);
      own.nodes.insert(own.nodes.end(), corners.begin(), corners.end());
    }
    Group group{.name = given.name, .cells = {}, .vertices = {}};
    for (Index f = 0; f < facets.num_cells(); ++f) {
      const Index t = nearest[static_cast<std::size_t>(f)];
      if (t < 0 || !has[static_cast<std::size_t>(t)]) continue;
      const std::span<const Index> corners = facets.cell(f);
      group.vertices.insert(group.vertices.end(), corners.begin(), corners.end());
    }
    if (is_closed(own)) {
      const WindingNumber winding(surface, own);
      group.cells.resize(solid_block + 1);
      for (Index cell = 0; cell < solid->num_cells(); ++cell) {
        const std::span<const Index> nodes = solid->cell(cell);
        if (std::abs(winding(centroid_of(cells, nodes))) < 0.5) continue;
        group.cells[solid_block].push_back(cell);
        group.vertices.insert(group.vertices.end(), nodes.begin(), nodes.end());
      }
    }
    std::ranges::sort(group.vertices);
    group.vertices.erase(std::unique(group.vertices.begin(), group.vertices.end()), group.vertices.end());
    if (!group.vertices.empty()) cells.groups.push_back(std::move(group));
  }
}

}  // namespace resilin
