#include "resilin/mesh/round_generators.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <span>
#include <string>
#include <vector>

#include "resilin/mesh/edit.hpp"
#include "resilin/mesh/second_order.hpp"
#include "resilin/mesh/topology.hpp"

namespace resilin {
namespace {

constexpr double core_share = 0.55;      // half the diagonal of the core, by the radius
constexpr double core_roundness = 0.35;  // 0: straight sides

/// Where a node lies, as bits.
enum Side : unsigned { inner = 1, outer = 2, bottom = 4, top = 8, start = 16, end = 32 };

struct RoundNodes {
  std::vector<Vector3> places;
  std::vector<unsigned> sides;
  std::vector<int> layers;  ///< nodes of one layer lie on one circle or sphere; -1 in a core
};

/// Shares of the way outwards, from 0 to 1, cells growing by the same factor.
std::vector<double> graded(int cells, double grading) {
  std::vector<double> shares = {0};
  const double factor = cells > 1 ? std::pow(grading, 1.0 / (cells - 1)) : 1;
  double length = 1;
  for (int i = 0; i < cells; ++i, length *= factor) shares.push_back(shares.back() + length);
  for (double& share : shares) share /= shares[static_cast<std::size_t>(cells)];
  return shares;
}

/// The direction of a point of the surface of the square or cube [-1, 1]^dim, angles being divided evenly.
Vector3 direction_of(const Vector3& on_cube) {
  Vector3 direction;
  for (int k = 0; k < 3; ++k) direction[k] = std::tan(std::numbers::pi / 4 * on_cube[k]);
  return direction.normalized();
}

/// A point of the core of a disc or ball of radius 1.
Vector3 core_place(const Vector3& in_cube, int dim) {
  const double r = in_cube.cwiseAbs().maxCoeff();
  if (r == 0) return Vector3::Zero();
  const Vector3 straight = in_cube / std::sqrt(static_cast<double>(dim));
  const Vector3 round = r * direction_of(in_cube / r);
  return core_share * ((1 - core_roundness * r) * straight + core_roundness * r * round);
}

/// Cells of a plane or solid cross-section, corners in the order of MSH.
struct Blocks {
  RoundNodes nodes;
  std::vector<std::vector<Index>> cells;
};

/// A disc or ball: a core of n^dim cells, and layers on each of its sides; or such layers alone.
class CubedBall {
 public:
  CubedBall(int dim, int n) : dim_(dim), n_(n) {}

  Blocks full(const RoundShape& shape) {
    const int num_layers = std::max(1, shape.radial_cells - shape.radial_cells / 2);
    const std::vector<double> shares = graded(num_layers, shape.grading);
    place_ = [this, shares, &shape](int layer, const Vector3& q) {
      const Vector3 core = core_place(q, dim_), rim = direction_of(q);
      if (layer == 0) return Vector3(shape.radius * core);
      const double t = shares[static_cast<std::size_t>(layer)];
      return Vector3(shape.radius * ((1 - t) * core + t * rim));
    };
    last_layer_ = num_layers;
    const int depth = dim_ == 3 ? n_ : 1;
    for (int k = 0; k < depth; ++k)
      for (int j = 0; j < n_; ++j)
        for (int i = 0; i < n_; ++i) add_core_cell({i, j, k});
    add_layers(num_layers);
    return std::move(blocks_);
  }

  Blocks hollow(const RoundShape& shape) {
    const std::vector<double> shares = graded(shape.radial_cells, shape.grading);
    place_ = [shares, &shape](int layer, const Vector3& q) {
      const double t = shares[static_cast<std::size_t>(layer)];
      return Vector3(((1 - t) * shape.inner_radius + t * shape.radius) * direction_of(q));
    };
    is_hollow_ = true;
    last_layer_ = shape.radial_cells;
    add_layers(shape.radial_cells);
    return std::move(blocks_);
  }

 private:
  using Place = std::array<int, 3>;

  Index node(int layer, const Place& at) {
    const auto [found, is_new] =
        numbers_.try_emplace({layer, at[0], at[1], at[2]}, static_cast<Index>(numbers_.size()));
    if (!is_new) return found->second;
    Vector3 q = Vector3::Zero();
    for (int k = 0; k < dim_; ++k) q[k] = 2.0 * at[static_cast<std::size_t>(k)] / n_ - 1;
    blocks_.nodes.places.push_back(place_(layer, q));
    blocks_.nodes.sides.push_back((layer == last_layer_ ? outer : 0U) |
                                  (is_hollow_ && layer == 0 ? inner : 0U));
    blocks_.nodes.layers.push_back(is_hollow_ || layer == last_layer_ ? layer : -1);
    return found->second;
  }

  void add_core_cell(const Place& p) {
    std::vector<Index> cell;
    for (int c = 0; c < (dim_ == 3 ? 8 : 4); ++c)
      cell.push_back(node(0, {p[0] + (c % 4 == 1 || c % 4 == 2 ? 1 : 0), p[1] + (c % 4 > 1 ? 1 : 0),
                              p[2] + (c > 3 ? 1 : 0)}));
    blocks_.cells.push_back(cell);
  }

  /// On each side of the core its squares (2D: edges), pulled outwards.
  void add_layers(int num_layers) {
    for (std::size_t axis = 0; axis < static_cast<std::size_t>(dim_); ++axis)
      for (const int at : {0, n_})
        for (int layer = 0; layer < num_layers; ++layer)
          for (int v = 0; v < (dim_ == 3 ? n_ : 1); ++v)
            for (int u = 0; u < n_; ++u) {
              std::vector<Index> cell;
              for (const int l : {layer, layer + 1})
                for (int c = 0; c < (dim_ == 3 ? 4 : 2); ++c) {
                  Place p{};
                  p[axis] = at;
                  const std::size_t a = (axis + 1) % static_cast<std::size_t>(dim_);
                  const std::size_t b = (axis + 2) % 3;
                  p[a] = u + (c == 1 || c == 2 ? 1 : 0);
                  if (dim_ == 3) p[b] = v + (c > 1 ? 1 : 0);
                  cell.push_back(node(l, p));
                }
              if (dim_ == 2) std::swap(cell[2], cell[3]);  // around the quadrilateral
              blocks_.cells.push_back(cell);
            }
  }

  int dim_, n_, last_layer_ = 0;
  bool is_hollow_ = false;
  std::function<Vector3(int layer, const Vector3& on_cube)> place_;
  std::map<std::array<int, 4>, Index> numbers_;
  Blocks blocks_;
};

Blocks ring(const RoundShape& shape) {
  Blocks blocks;
  const bool is_closed = shape.degrees >= 360;
  const int columns = shape.around_cells + (is_closed ? 0 : 1), rows = shape.radial_cells + 1;
  const std::vector<double> shares = graded(shape.radial_cells, shape.grading);
  for (int j = 0; j < columns; ++j)
    for (int i = 0; i < rows; ++i) {
      const double angle = shape.degrees / 180 * std::numbers::pi * j / shape.around_cells;
      const double t = shares[static_cast<std::size_t>(i)];
      const double r = (1 - t) * shape.inner_radius + t * shape.radius;
      blocks.nodes.places.emplace_back(r * std::cos(angle), r * std::sin(angle), 0);
      unsigned sides = (i == 0 ? inner : 0U) | (i + 1 == rows ? outer : 0U);
      if (!is_closed) sides |= (j == 0 ? start : 0U) | (j == shape.around_cells ? end : 0U);
      blocks.nodes.sides.push_back(sides);
      blocks.nodes.layers.push_back(i);
    }
  for (int j = 0; j < shape.around_cells; ++j)
    for (int i = 0; i + 1 < rows; ++i) {
      const int next = (j + 1) % columns;
      blocks.cells.push_back({i + rows * j, i + 1 + rows * j, i + 1 + rows * next, i + rows * next});
    }
  return blocks;
}

/// A plane cross-section pulled along z.
Blocks extruded(const Blocks& plane, double height, int cells) {
  Blocks blocks;
  const auto count = static_cast<Index>(plane.nodes.places.size());
  for (int k = 0; k <= cells; ++k)
    for (std::size_t v = 0; v < plane.nodes.places.size(); ++v) {
      blocks.nodes.places.push_back(plane.nodes.places[v] + Vector3(0, 0, height * k / cells));
      blocks.nodes.sides.push_back(plane.nodes.sides[v] | (k == 0 ? bottom : 0U) | (k == cells ? top : 0U));
      blocks.nodes.layers.push_back(plane.nodes.layers[v]);
    }
  for (int k = 0; k < cells; ++k)
    for (const std::vector<Index>& base : plane.cells) {
      std::vector<Index> cell;
      for (const int level : {k, k + 1})
        for (const Index v : base) cell.push_back(v + count * level);
      blocks.cells.push_back(cell);
    }
  return blocks;
}

/// Positive for corners in the order of MSH.
double signed_size(const std::vector<Vector3>& places, std::span<const Index> c) {
  const auto from_first = [&](std::size_t a) {
    return Vector3(places[static_cast<std::size_t>(c[a])] - places[static_cast<std::size_t>(c[0])]);
  };
  const Vector3 normal = from_first(1).cross(from_first(3));
  return c.size() == 8 ? normal.dot(from_first(4)) : normal.z();
}

/// Six tetrahedra from the vertex of the least number to the triangles of the three sides without it, each
/// side cut through its own, so that neighbours agree.
void cut_hexahedron(std::span<const Index> cell, const std::vector<Vector3>& places,
                    std::vector<Index>& nodes) {
  const Index apex = std::ranges::min(cell);
  for (const CellSide& side : cell_sides(CellKind::hexahedron)) {
    std::array<Index, 4> corners{};
    for (std::size_t a = 0; a < 4; ++a) corners[a] = cell[static_cast<std::size_t>(side.nodes[a])];
    if (std::ranges::find(corners, apex) != corners.end()) continue;
    std::ranges::rotate(corners, std::ranges::min_element(corners));
    for (const std::size_t k : {std::size_t{1}, std::size_t{2}}) {
      std::array<Index, 4> tet = {corners[0], corners[k], corners[k + 1], apex};
      const auto at = [&](std::size_t a) -> const Vector3& {
        return places[static_cast<std::size_t>(tet[a])];
      };
      if ((at(1) - at(0)).cross(at(2) - at(0)).dot(at(3) - at(0)) < 0) std::swap(tet[1], tet[2]);
      nodes.insert(nodes.end(), tet.begin(), tet.end());
    }
  }
}

Mesh as_mesh(Blocks blocks, int dim, bool is_cut) {
  Mesh mesh;
  mesh.vertices = std::move(blocks.nodes.places);
  CellBlock cells{.kind = dim == 3 ? (is_cut ? CellKind::tetrahedron : CellKind::hexahedron)
                                   : (is_cut ? CellKind::triangle : CellKind::quadrilateral),
                  .nodes = {}};
  for (std::vector<Index>& cell : blocks.cells) {
    if (signed_size(mesh.vertices, cell) < 0) {
      if (dim == 3) {
        std::swap_ranges(cell.begin(), cell.begin() + 4, cell.begin() + 4);
      } else {
        std::reverse(cell.begin(), cell.end());
      }
    }
    if (!is_cut) {
      cells.nodes.insert(cells.nodes.end(), cell.begin(), cell.end());
    } else if (dim == 3) {
      cut_hexahedron(cell, mesh.vertices, cells.nodes);
    } else {
      const auto at = [&](std::size_t a) -> const Vector3& {
        return mesh.vertices[static_cast<std::size_t>(cell[a])];
      };
      if ((at(2) - at(0)).norm() > (at(3) - at(1)).norm())
        std::rotate(cell.begin(), cell.begin() + 1, cell.end());
      for (const std::size_t a : {0, 1, 2, 0, 2, 3}) cells.nodes.push_back(cell[a]);
    }
  }
  mesh.blocks.push_back(std::move(cells));
  return mesh;
}

void add_groups(const std::vector<unsigned>& sides, Mesh& mesh) {
  Group body{.name = "body", .cells = {{}}, .vertices = {}};
  for (Index cell = 0; cell < mesh.blocks[0].num_cells(); ++cell) body.cells[0].push_back(cell);
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) body.vertices.push_back(static_cast<Index>(v));
  mesh.groups.push_back(std::move(body));
  const CellBlock surface = boundary(mesh.blocks[0]).facets;
  CellBlock facets{.kind = surface.kind, .nodes = {}};
  struct NamedSide {
    Side side;
    const char* name;
  };
  constexpr std::array<NamedSide, 6> named = {
      {{inner, "inner"}, {outer, "outer"}, {bottom, "bottom"}, {top, "top"}, {start, "start"}, {end, "end"}}};
  for (const NamedSide& of : named) {
    Group group{.name = of.name, .cells = {{}, {}}, .vertices = {}};
    for (Index f = 0; f < surface.num_cells(); ++f) {
      const std::span<const Index> nodes = surface.cell(f);
      if (!std::ranges::all_of(nodes,
                               [&](Index v) { return (sides[static_cast<std::size_t>(v)] & of.side) != 0; }))
        continue;
      group.cells[1].push_back(facets.num_cells());
      facets.nodes.insert(facets.nodes.end(), nodes.begin(), nodes.end());
      group.vertices.insert(group.vertices.end(), nodes.begin(), nodes.end());
    }
    std::ranges::sort(group.vertices);
    group.vertices.erase(std::unique(group.vertices.begin(), group.vertices.end()), group.vertices.end());
    if (!group.vertices.empty()) mesh.groups.push_back(std::move(group));
  }
  mesh.blocks.push_back(std::move(facets));
}

/// Middles of edges along a circle or sphere go onto it; those between two of them to the mean radius, so
/// that cells of thin walls bend with the wall.
Mesh rounded(const Mesh& mesh, const std::vector<int>& layers, bool is_spherical) {
  SecondOrderMesh made = second_order(mesh);
  const auto radius = [&](const Vector3& X) { return is_spherical ? X.norm() : X.head<2>().norm(); };
  for (std::size_t i = 0; i < made.ends.size(); ++i) {
    const auto a = static_cast<std::size_t>(made.ends[i][0]), b = static_cast<std::size_t>(made.ends[i][1]);
    if (layers[a] < 0 || layers[b] < 0) continue;
    Vector3& middle = made.mesh.vertices[mesh.vertices.size() + i];
    const double wanted = 0.5 * (radius(mesh.vertices[a]) + radius(mesh.vertices[b])), now = radius(middle);
    if (now == 0) continue;
    if (is_spherical) {
      middle *= wanted / now;
    } else {
      middle.head<2>() *= wanted / now;
    }
  }
  return std::move(made.mesh);
}

}  // namespace

bool has_hole(RoundKind kind) {
  return kind == RoundKind::ring || kind == RoundKind::tube || kind == RoundKind::spherical_shell;
}

bool has_height(RoundKind kind) { return kind == RoundKind::cylinder || kind == RoundKind::tube; }

int dimension(RoundKind kind) { return kind == RoundKind::disc || kind == RoundKind::ring ? 2 : 3; }

Mesh make_round(const RoundShape& shape) {
  const int dim = dimension(shape.kind);
  const bool is_spherical = shape.kind == RoundKind::ball || shape.kind == RoundKind::spherical_shell;
  Blocks blocks;
  if (shape.kind == RoundKind::spherical_shell) {
    blocks = CubedBall(3, std::max(1, (shape.around_cells + 3) / 4)).hollow(shape);
  } else if (shape.kind == RoundKind::ball) {
    blocks = CubedBall(3, std::max(1, shape.radial_cells)).full(shape);
  } else {
    blocks = has_hole(shape.kind) ? ring(shape) : CubedBall(2, std::max(1, shape.radial_cells)).full(shape);
    if (has_height(shape.kind)) blocks = extruded(blocks, shape.height, shape.axial_cells);
  }
  const std::vector<unsigned> sides = blocks.nodes.sides;
  const std::vector<int> layers = blocks.nodes.layers;
  Mesh mesh = as_mesh(std::move(blocks), dim, shape.is_cut);
  add_groups(sides, mesh);
  return shape.is_quadratic && shape.is_cut ? rounded(mesh, layers, is_spherical) : mesh;
}

}  // namespace resilin
