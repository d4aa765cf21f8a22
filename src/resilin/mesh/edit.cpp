#include "resilin/mesh/edit.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <numbers>
#include <utility>

#include "resilin/core/error.hpp"
#include "resilin/mesh/quality.hpp"
#include "resilin/mesh/topology.hpp"

namespace resilin {
namespace {

/// Positions to exchange in a cell's node list. In simplices the last two corners and the edge nodes that
/// follow them.
std::vector<std::pair<std::size_t, std::size_t>> exchanges(CellKind kind) {
  switch (kind) {
    case CellKind::triangle:
      return {{1, 2}};
    case CellKind::triangle6:
      return {{1, 2}, {3, 5}};
    case CellKind::tetrahedron:
      return {{2, 3}};
    case CellKind::tetrahedron10:
      return {{2, 3}, {5, 9}, {6, 7}};
    case CellKind::quadrilateral:
      return {{1, 3}};
    case CellKind::hexahedron:
      return {{0, 4}, {1, 5}, {2, 6}, {3, 7}};
    case CellKind::point:
    case CellKind::line:
    case CellKind::line3:
    case CellKind::prism:
    case CellKind::pyramid:
      break;
  }
  return {};
}

std::vector<bool> used_by_any_cell(const Mesh& mesh) {
  std::vector<bool> is_used(mesh.vertices.size(), false);
  for (const CellBlock& block : mesh.blocks) {
    for (const Index node : block.nodes) is_used[static_cast<std::size_t>(node)] = true;
  }
  return is_used;
}

/// Rewrites all node numbers; -1 drops a vertex from groups (no cell may use it).
void renumber(Mesh& mesh, const std::vector<Index>& new_number) {
  const auto renumbered = [&](Index node) { return new_number[static_cast<std::size_t>(node)]; };
  for (CellBlock& block : mesh.blocks) {
    for (Index& node : block.nodes) node = renumbered(node);
  }
  for (Group& group : mesh.groups) {
    std::vector<Index> kept;
    for (const Index vertex : group.vertices) {
      if (renumbered(vertex) >= 0) kept.push_back(renumbered(vertex));
    }
    std::sort(kept.begin(), kept.end());
    kept.erase(std::unique(kept.begin(), kept.end()), kept.end());
    group.vertices = std::move(kept);
  }
}

/// Triangles by their corners; a quadrilateral (a, b, c, d) becomes (a, b, c), (a, c, d).
CellBlock triangles_of(const CellBlock& faces) {
  CellBlock triangles{CellKind::triangle, {}};
  for (Index face = 0; face < faces.num_cells(); ++face) {
    const auto corners = faces.cell(face);
    for (std::size_t i = 2; i < static_cast<std::size_t>(num_corners(faces.kind)); ++i)
      triangles.nodes.insert(triangles.nodes.end(), {corners[0], corners[i - 1], corners[i]});
  }
  return triangles;
}

}  // namespace

void turn_around(CellKind kind, std::span<Index> nodes) {
  for (const auto& [a, b] : exchanges(kind)) std::swap(nodes[a], nodes[b]);
}

std::vector<Index> reorient(Mesh& mesh, CellKind kind) {
  const CellBlock* found = mesh.find_block(kind);
  if (found == nullptr) return {};
  CellBlock& block = mesh.block(kind);
  const std::vector<double> volumes = signed_volumes(mesh, block);
  std::vector<Index> inverted;
  for (Index cell = 0; cell < block.num_cells(); ++cell) {
    if (!(volumes[static_cast<std::size_t>(cell)] < 0)) continue;
    inverted.push_back(cell);
    const auto first = static_cast<std::size_t>(cell) * static_cast<std::size_t>(num_nodes(kind));
    turn_around(kind, std::span(block.nodes).subspan(first, static_cast<std::size_t>(num_nodes(kind))));
  }
  return inverted;
}

bool to_first_order(Mesh& mesh) {
  bool had_any = false;
  for (std::size_t b = 0; b < mesh.blocks.size(); ++b) {
    const CellKind kind = mesh.blocks[b].kind;
    const CellKind reduced = first_order(kind);
    if (reduced == kind || mesh.find_block(reduced) != nullptr) continue;
    had_any = true;
    std::vector<Index> corners;
    for (Index cell = 0; cell < mesh.blocks[b].num_cells(); ++cell) {
      const auto nodes = mesh.blocks[b].cell(cell).first(static_cast<std::size_t>(num_nodes(reduced)));
      corners.insert(corners.end(), nodes.begin(), nodes.end());
    }
    mesh.blocks[b] = {reduced, std::move(corners)};
  }
  return had_any;
}

std::vector<Index> remove_unused_nodes(Mesh& mesh) {
  const std::vector<bool> is_used = used_by_any_cell(mesh);
  std::vector<Index> new_number(mesh.vertices.size(), -1);
  std::vector<Vector3> kept;
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    if (!is_used[v]) continue;
    new_number[v] = static_cast<Index>(kept.size());
    kept.push_back(mesh.vertices[v]);
  }
  mesh.vertices = std::move(kept);
  renumber(mesh, new_number);
  return new_number;
}

std::vector<Index> merge_duplicate_vertices(Mesh& mesh) {
  std::vector<Index> joined(mesh.vertices.size());
  for (std::size_t v = 0; v < joined.size(); ++v) joined[v] = static_cast<Index>(v);
  for (const auto& [first, later] : duplicate_vertices(mesh)) joined[static_cast<std::size_t>(later)] = first;
  renumber(mesh, joined);
  const std::vector<Index> compacted = remove_unused_nodes(mesh);
  for (Index& vertex : joined) vertex = compacted[static_cast<std::size_t>(vertex)];
  return joined;
}

Surface extract_surface(const Mesh& mesh) {
  const CellBlock* solid = mesh.find_solid(3);
  const CellBlock* plane = mesh.find_solid(2);
  if (solid == nullptr && plane == nullptr) {
    throw InputError("mesh", "no tetrahedra, no hexahedra and no triangles: it has no surface");
  }
  Surface surface;
  surface.mesh.vertices = mesh.vertices;
  surface.mesh.blocks = {triangles_of(visible_facets(solid != nullptr ? *solid : *plane).facets)};
  const std::vector<Index> new_number = remove_unused_nodes(surface.mesh);
  for (std::size_t v = 0; v < new_number.size(); ++v) {
    if (new_number[v] >= 0) surface.volume_vertices.push_back(static_cast<Index>(v));
  }
  return surface;
}

void transform(Mesh& mesh, const Matrix<3>& A, const Vector3& b) {
  for (Vector3& X : mesh.vertices) X = (A * X + b).eval();
}

Matrix<3> rotation_matrix(const Vector3& axis, double degrees) {
  if (!(axis.norm() > 0)) throw InputError("rotation axis", "a vector that is not zero", "zero");
  return Eigen::AngleAxisd(degrees * std::numbers::pi / 180, axis.normalized()).toRotationMatrix();
}

BoundingBox bounding_box(const Mesh& mesh) {
  const std::vector<bool> is_used = used_by_any_cell(mesh);
  BoundingBox box;
  bool is_first = true;
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    if (!is_used[v]) continue;
    box.min = is_first ? mesh.vertices[v] : box.min.cwiseMin(mesh.vertices[v]).eval();
    box.max = is_first ? mesh.vertices[v] : box.max.cwiseMax(mesh.vertices[v]).eval();
    is_first = false;
  }
  return box;
}

}  // namespace resilin
