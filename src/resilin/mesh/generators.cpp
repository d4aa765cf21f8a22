#include "resilin/mesh/generators.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <string>

#include "resilin/core/error.hpp"
#include "resilin/core/memory.hpp"
#include "resilin/core/text.hpp"
#include "resilin/mesh/edit.hpp"
#include "resilin/mesh/topology.hpp"

namespace resilin {
namespace {

using Corners = std::array<int, 4>;
constexpr std::array<Corners, 6> kuhn_tets = {
    {{0, 1, 3, 7}, {0, 1, 7, 5}, {0, 5, 7, 4}, {0, 3, 2, 7}, {0, 2, 6, 7}, {0, 6, 4, 7}}};
constexpr std::array<Corners, 5> even_tets = {
    {{0, 1, 2, 4}, {3, 1, 7, 2}, {5, 1, 4, 7}, {6, 2, 7, 4}, {1, 2, 4, 7}}};
constexpr std::array<Corners, 5> odd_tets = {
    {{1, 0, 5, 3}, {2, 0, 3, 6}, {4, 0, 6, 5}, {7, 3, 5, 6}, {0, 3, 6, 5}}};

/// The regular grid of nodes; a 2D grid has one layer of nodes in z.
struct Grid {
  std::array<int, 3> cells;
  std::array<int, 3> nodes;

  explicit Grid(const std::array<int, 3>& num_cells) : cells(num_cells), nodes{} {
    for (std::size_t a = 0; a < 3; ++a) nodes[a] = cells[a] + 1;
  }
  Index node(int i, int j, int k) const { return i + nodes[0] * (j + nodes[1] * k); }
  std::array<int, 3> place(Index node) const {
    return {node % nodes[0], node / nodes[0] % nodes[1], node / nodes[0] / nodes[1]};
  }
};

void check_size(const std::string& what, const std::string& component, double size, int cells) {
  if (!(size > 0) || !std::isfinite(size)) {
    throw InputError(what + ": size " + component, "a positive length [m]", format_number(size));
  }
  if (cells < 1) throw InputError(what + ": cells " + component, "at least 1", std::to_string(cells));
}

/// Numbers of nodes and of cell corners have to fit the 32-bit node numbers.
void check_count(const std::string& what, const std::array<int, 3>& cells, int cells_per_cube) {
  std::int64_t count = cells_per_cube;
  for (const int n : cells) {
    count *= n + std::int64_t{1};
    if (count > std::numeric_limits<Index>::max()) {
      throw InputError(what + ": cells", "fewer than 2^31 cells and nodes", "more", "use a coarser mesh");
    }
  }
}

/// Throws OutOfMemory where the mesh of a grid does not fit: vertices, cells, and the group of them all.
void foresee_mesh(const std::array<int, 3>& cells, std::size_t cells_per_cube, CellKind kind) {
  double num_cells = static_cast<double>(cells_per_cube), num_vertices = 1;
  for (const int n : cells) {
    num_cells *= std::max(n, 1);
    num_vertices *= n + 1.0;
  }
  const double bytes =
      num_cells * (num_nodes(kind) + 1) * sizeof(Index) + num_vertices * (sizeof(Vector3) + sizeof(Index));
  if (!fits(bytes))
    foresee_memory(bytes, "a box of " + std::to_string(static_cast<std::int64_t>(num_cells)) + " cells",
                   what_would_fit(num_cells, bytes, "cells") + ": take fewer, or raise the limit");
}

void check_box(const Vector3& size, const std::array<int, 3>& cells) {
  for (std::size_t a = 0; a < 3; ++a)
    check_size("box", std::string(1, "xyz"[a]), size[static_cast<Eigen::Index>(a)], cells[a]);
  check_count("box", cells, 8);
}

void check_rectangle(const Vector<2>& size, const std::array<int, 2>& cells) {
  for (std::size_t a = 0; a < 2; ++a)
    check_size("rectangle", std::string(1, "xy"[a]), size[static_cast<Eigen::Index>(a)], cells[a]);
  check_count("rectangle", {cells[0], cells[1], 0}, 4);
}

std::vector<Vector3> grid_vertices(const Grid& grid, const Vector3& size, const Vector3& origin) {
  std::vector<Vector3> vertices;
  vertices.reserve(static_cast<std::size_t>(grid.nodes[0]) * static_cast<std::size_t>(grid.nodes[1]) *
                   static_cast<std::size_t>(grid.nodes[2]));
  const auto coordinate = [&](int axis, int i) {
    const int n = grid.cells[static_cast<std::size_t>(axis)];
    if (i == 0) return origin[axis];
    return origin[axis] + (i == n ? size[axis] : size[axis] * i / n);
  };
  for (int k = 0; k < grid.nodes[2]; ++k) {
    for (int j = 0; j < grid.nodes[1]; ++j) {
      for (int i = 0; i < grid.nodes[0]; ++i) {
        vertices.emplace_back(coordinate(0, i), coordinate(1, j), coordinate(2, k));
      }
    }
  }
  return vertices;
}

/// Adds the boundary as a block, with one group for each side of the grid, and the group "body".
void add_groups(Mesh& mesh, const Grid& grid, int dim) {
  mesh.blocks.push_back(boundary(mesh.blocks[0]).facets);
  const CellBlock& sides = mesh.blocks[1];

  Group body{"body", {{}}, {}};
  body.cells[0].resize(static_cast<std::size_t>(mesh.blocks[0].num_cells()));
  std::iota(body.cells[0].begin(), body.cells[0].end(), 0);
  body.vertices.resize(mesh.vertices.size());
  std::iota(body.vertices.begin(), body.vertices.end(), 0);
  mesh.groups.push_back(std::move(body));

  for (std::size_t axis = 0; axis < static_cast<std::size_t>(dim); ++axis) {
    for (const bool is_max : {false, true}) {
      const int place = is_max ? grid.cells[axis] : 0;
      const auto is_on_side = [&](Index node) { return grid.place(node)[axis] == place; };
      Group side{std::string(1, "xyz"[axis]) + (is_max ? "_max" : "_min"), {{}, {}}, {}};
      for (Index facet = 0; facet < sides.num_cells(); ++facet) {
        const auto nodes = sides.cell(facet);
        if (std::all_of(nodes.begin(), nodes.end(), is_on_side)) side.cells[1].push_back(facet);
      }
      for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
        if (is_on_side(static_cast<Index>(v))) side.vertices.push_back(static_cast<Index>(v));
      }
      mesh.groups.push_back(std::move(side));
    }
  }
}

}  // namespace

Mesh make_box(const Vector3& size, const std::array<int, 3>& cells, const Vector3& origin,
              TetPattern pattern) {
  check_box(size, cells);
  const std::size_t tets_per_cube = pattern == TetPattern::kuhn6 ? kuhn_tets.size() : even_tets.size();
  foresee_mesh(cells, tets_per_cube, CellKind::tetrahedron);
  const Grid grid(cells);
  Mesh mesh;
  mesh.vertices = grid_vertices(grid, size, origin);
  mesh.blocks.push_back({CellKind::tetrahedron, {}});
  std::vector<Index>& nodes = mesh.blocks[0].nodes;
  nodes.reserve(4 * tets_per_cube * static_cast<std::size_t>(cells[0]) * static_cast<std::size_t>(cells[1]) *
                static_cast<std::size_t>(cells[2]));
  for (int k = 0; k < cells[2]; ++k) {
    for (int j = 0; j < cells[1]; ++j) {
      for (int i = 0; i < cells[0]; ++i) {
        const auto add = [&](const Corners& tet) {
          for (const int c : tet) nodes.push_back(grid.node(i + (c & 1), j + (c >> 1 & 1), k + (c >> 2 & 1)));
        };
        if (pattern == TetPattern::kuhn6) {
          for (const Corners& tet : kuhn_tets) add(tet);
        } else {
          for (const Corners& tet : (i + j + k) % 2 == 0 ? even_tets : odd_tets) add(tet);
        }
      }
    }
  }
  reorient(mesh, CellKind::tetrahedron);
  add_groups(mesh, grid, 3);
  return mesh;
}

Mesh make_hexahedron_box(const Vector3& size, const std::array<int, 3>& cells, const Vector3& origin) {
  check_box(size, cells);
  foresee_mesh(cells, 1, CellKind::hexahedron);
  const Grid grid(cells);
  Mesh mesh;
  mesh.vertices = grid_vertices(grid, size, origin);
  mesh.blocks.push_back({CellKind::hexahedron, {}});
  mesh.blocks[0].nodes.reserve(8 * static_cast<std::size_t>(cells[0]) * static_cast<std::size_t>(cells[1]) *
                               static_cast<std::size_t>(cells[2]));
  for (int k = 0; k < cells[2]; ++k)
    for (int j = 0; j < cells[1]; ++j)
      for (int i = 0; i < cells[0]; ++i)
        for (const int c : {0, 1, 3, 2, 4, 5, 7, 6})
          mesh.blocks[0].nodes.push_back(grid.node(i + (c & 1), j + (c >> 1 & 1), k + (c >> 2 & 1)));
  add_groups(mesh, grid, 3);
  return mesh;
}

Mesh make_rectangle(const Vector<2>& size, const std::array<int, 2>& cells, const Vector<2>& origin,
                    TrianglePattern pattern) {
  check_rectangle(size, cells);
  foresee_mesh({cells[0], cells[1], 0}, 2, CellKind::triangle);
  const Grid grid({cells[0], cells[1], 0});
  Mesh mesh;
  mesh.vertices = grid_vertices(grid, {size.x(), size.y(), 0}, {origin.x(), origin.y(), 0});
  mesh.blocks.push_back({CellKind::triangle, {}});
  std::vector<Index>& nodes = mesh.blocks[0].nodes;
  nodes.reserve(6 * static_cast<std::size_t>(cells[0]) * static_cast<std::size_t>(cells[1]));
  for (int j = 0; j < cells[1]; ++j) {
    for (int i = 0; i < cells[0]; ++i) {
      const Index a = grid.node(i, j, 0);
      const Index b = grid.node(i + 1, j, 0);
      const Index c = grid.node(i + 1, j + 1, 0);
      const Index d = grid.node(i, j + 1, 0);
      const bool has_other_diagonal = pattern == TrianglePattern::alternating && (i + j) % 2 == 1;
      const std::array<Index, 6> split =
          has_other_diagonal ? std::array{a, b, d, b, c, d} : std::array{a, b, c, a, c, d};
      nodes.insert(nodes.end(), split.begin(), split.end());
    }
  }
  add_groups(mesh, grid, 2);
  return mesh;
}

Mesh make_quadrilateral_rectangle(const Vector<2>& size, const std::array<int, 2>& cells,
                                  const Vector<2>& origin) {
  check_rectangle(size, cells);
  const Grid grid({cells[0], cells[1], 0});
  Mesh mesh;
  mesh.vertices = grid_vertices(grid, {size.x(), size.y(), 0}, {origin.x(), origin.y(), 0});
  mesh.blocks.push_back({CellKind::quadrilateral, {}});
  for (int j = 0; j < cells[1]; ++j)
    for (int i = 0; i < cells[0]; ++i)
      for (const int c : {0, 1, 3, 2})
        mesh.blocks[0].nodes.push_back(grid.node(i + (c & 1), j + (c >> 1), 0));
  add_groups(mesh, grid, 2);
  return mesh;
}

}  // namespace resilin
