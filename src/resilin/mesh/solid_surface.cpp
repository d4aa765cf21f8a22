#include "resilin/mesh/solid_surface.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <utility>
#include <vector>

#include "resilin/core/error.hpp"
#include "resilin/mesh/box_tree.hpp"
#include "resilin/mesh/edit.hpp"
#include "resilin/mesh/quality.hpp"
#include "resilin/mesh/topology.hpp"

namespace resilin {
namespace {

constexpr double sheet_share =
    1.0 / 3;  // share of lids in the surface, beyond which it is a sheet: half a ball has 1/2
constexpr double thinnest = 1e-9;  // volume by area^(3/2): below it is nothing but rounding

/// A directed side of a triangle, its ends in rising order.
struct Side {
  Index low, high;
  Index triangle;
  bool is_rising;  ///< the triangle goes from low to high
};

/// A triangle on the other side of an edge.
struct Neighbor {
  Index triangle;
  bool is_wound_alike;
};

std::vector<Side> sides_of(const CellBlock& triangles) {
  std::vector<Side> sides;
  for (Index t = 0; t < triangles.num_cells(); ++t) {
    const auto nodes = triangles.cell(t);
    for (std::size_t i = 0; i < 3; ++i) {
      const Index a = nodes[i], b = nodes[(i + 1) % 3];
      sides.push_back({std::min(a, b), std::max(a, b), t, a < b});
    }
  }
  std::ranges::stable_sort(
      sides, [](const Side& a, const Side& b) { return a.low != b.low ? a.low < b.low : a.high < b.high; });
  return sides;
}

/// Edges along which triangles go more often one way than the other.
CellBlock unbalanced_edges(const CellBlock& triangles) {
  CellBlock edges{.kind = CellKind::line, .nodes = {}};
  const std::vector<Side> sides = sides_of(triangles);
  for (std::size_t begin = 0, end = 0; begin < sides.size(); begin = end) {
    int sum = 0;
    for (; end < sides.size() && sides[end].low == sides[begin].low && sides[end].high == sides[begin].high;
         ++end)
      sum += sides[end].is_rising ? 1 : -1;
    if (sum != 0) edges.nodes.insert(edges.nodes.end(), {sides[begin].low, sides[begin].high});
  }
  return edges;
}

/// Across edges of exactly two triangles.
std::vector<std::vector<Neighbor>> neighbors_of(const CellBlock& triangles) {
  std::vector<std::vector<Neighbor>> neighbors(static_cast<std::size_t>(triangles.num_cells()));
  const std::vector<Side> sides = sides_of(triangles);
  for (std::size_t begin = 0, end = 0; begin < sides.size(); begin = end) {
    while (end < sides.size() && sides[end].low == sides[begin].low && sides[end].high == sides[begin].high)
      ++end;
    if (end - begin != 2) continue;
    const Side &a = sides[begin], &b = sides[begin + 1];
    const bool is_alike = a.is_rising != b.is_rising;
    neighbors[static_cast<std::size_t>(a.triangle)].push_back({b.triangle, is_alike});
    neighbors[static_cast<std::size_t>(b.triangle)].push_back({a.triangle, is_alike});
  }
  return neighbors;
}

/// @return how many were turned
Index wind_alike(const Mesh& mesh, CellBlock& triangles) {
  const auto neighbors = neighbors_of(triangles);
  const std::vector<double> areas = triangle_areas(mesh, triangles);
  enum class Turn : char { unknown, no, yes };
  std::vector<Turn> turns(neighbors.size(), Turn::unknown);
  Index num_turned = 0;
  for (std::size_t start = 0; start < turns.size(); ++start) {
    if (turns[start] != Turn::unknown) continue;
    std::vector<std::size_t> patch = {start};
    turns[start] = Turn::no;
    double kept = 0, turned = 0;
    for (std::size_t i = 0; i < patch.size(); ++i) {
      const std::size_t t = patch[i];
      (turns[t] == Turn::yes ? turned : kept) += areas[t];
      for (const Neighbor& neighbor : neighbors[t]) {
        const auto other = static_cast<std::size_t>(neighbor.triangle);
        if (turns[other] != Turn::unknown) continue;
        turns[other] = neighbor.is_wound_alike == (turns[t] == Turn::no) ? Turn::no : Turn::yes;
        patch.push_back(other);
      }
    }
    const Turn meant = turned > kept ? Turn::no : Turn::yes;
    for (const std::size_t t : patch) {
      if (turns[t] != meant) continue;
      std::swap(triangles.nodes[3 * t + 1], triangles.nodes[3 * t + 2]);
      ++num_turned;
    }
  }
  return num_turned;
}

/// Triangles with the same vertex twice.
void drop_collapsed(CellBlock& triangles) {
  std::vector<Index> kept;
  for (Index t = 0; t < triangles.num_cells(); ++t) {
    const auto nodes = triangles.cell(t);
    if (nodes[0] != nodes[1] && nodes[1] != nodes[2] && nodes[2] != nodes[0])
      kept.insert(kept.end(), nodes.begin(), nodes.end());
  }
  triangles.nodes = std::move(kept);
}

/// Keeps one of triangles with the same vertices that are wound alike.
void drop_copies(CellBlock& triangles) {
  std::set<std::array<Index, 3>> seen;
  std::vector<Index> kept;
  for (Index t = 0; t < triangles.num_cells(); ++t) {
    const auto nodes = triangles.cell(t);
    std::array<Index, 3> key = {nodes[0], nodes[1], nodes[2]};
    std::ranges::rotate(key, std::ranges::min_element(key));
    if (seen.insert(key).second) kept.insert(kept.end(), nodes.begin(), nodes.end());
  }
  triangles.nodes = std::move(kept);
}

/// Least area of lids on the holes: the area vectors of a closed surface sum to zero.
double area_of_lids(const Mesh& mesh, const CellBlock& triangles) {
  Vector3 sum = Vector3::Zero();
  for (const Vector3& vector : triangle_area_vectors(mesh, triangles)) sum += vector;
  return sum.norm();
}

/// About the middle of the box, where lids that are missing count least.
double volume_of(const Mesh& mesh, const CellBlock& triangles) {
  const BoundingBox box = bounding_box(mesh);
  const Vector3 middle = 0.5 * (box.min + box.max);
  double volume = 0;
  for (Index t = 0; t < triangles.num_cells(); ++t) {
    const auto X = [&](std::size_t i) -> Vector3 {
      return mesh.vertices[static_cast<std::size_t>(triangles.cell(t)[i])] - middle;
    };
    volume += X(0).dot(X(1).cross(X(2))) / 6;
  }
  return std::abs(volume);
}

}  // namespace

bool is_closed(const CellBlock& triangles) {
  return triangles.num_cells() > 0 && unbalanced_edges(triangles).num_cells() == 0;
}

std::vector<OpenRim> open_rims(const Mesh& mesh, const CellBlock& triangles) {
  const CellBlock edges = unbalanced_edges(triangles);
  const Components parts = connected_components(edges, static_cast<Index>(mesh.vertices.size()));
  std::vector<Box> boxes(static_cast<std::size_t>(parts.count));
  for (Index e = 0; e < edges.num_cells(); ++e)
    for (const Index v : edges.cell(e))
      boxes[static_cast<std::size_t>(parts.of_cell[static_cast<std::size_t>(e)])].add(
          mesh.vertices[static_cast<std::size_t>(v)]);
  std::vector<OpenRim> rims;
  for (const Box& box : boxes) rims.push_back({0.5 * (box.min + box.max), 0.5 * (box.max - box.min).norm()});
  return rims;
}

SolidSurface make_solid_surface(const Mesh& mesh, const std::string& name) {
  SolidSurface surface;
  surface.mesh = mesh;
  to_first_order(surface.mesh);
  const CellBlock* triangles = surface.mesh.find_block(CellKind::triangle);
  if (triangles == nullptr || triangles->num_cells() == 0)
    throw InputError(name, "a surface of triangles", "none");
  surface.mesh.blocks = {CellBlock(*triangles)};
  surface.mesh.groups.clear();
  surface.mesh.cell_fields.clear();
  merge_duplicate_vertices(surface.mesh);
  drop_collapsed(surface.mesh.blocks[0]);
  drop_copies(surface.mesh.blocks[0]);
  remove_unused_nodes(surface.mesh);
  CellBlock& block = surface.mesh.blocks[0];
  for (const double area : triangle_areas(surface.mesh, block)) surface.area += area;
  if (!(surface.area > 0)) throw InputError(name, "triangles with an area", "points and lines alone");
  surface.num_turned = wind_alike(surface.mesh, block);
  surface.volume = volume_of(surface.mesh, block);
  if (!std::isfinite(surface.area) || !std::isfinite(surface.volume))
    throw InputError(name, "coordinates whose cubes are finite", "larger ones");
  surface.num_open_edges = open_edges(surface.mesh, block).size();
  surface.open_share = area_of_lids(surface.mesh, block) / surface.area;
  return surface;
}

void require_volume(const SolidSurface& surface, const std::string& name) {
  if (surface.num_open_edges > 0 && surface.open_share > sheet_share)
    throw InputError(name, "a surface that encloses a volume",
                     "an open sheet (" + std::to_string(surface.num_open_edges) + " open edges)",
                     "close it, or give it a thickness, in the program that it is from");
  if (surface.num_open_edges > 0) return;  // the guess of its volume may be anything
  if (surface.volume > thinnest * surface.area * std::sqrt(surface.area)) return;
  throw InputError(name, "a surface that encloses a volume",
                   "one that is flat or whose parts take each other's volume away");
}

std::vector<std::string> remarks_on(const SolidSurface& surface, const std::string& name) {
  std::vector<std::string> remarks;
  if (surface.num_open_edges > 0)
    remarks.push_back(name + ": " + std::to_string(surface.num_open_edges) +
                      " open edges; the winding number of the surface decides what is inside");
  if (surface.num_turned > 0)
    remarks.push_back(name + ": " + std::to_string(surface.num_turned) +
                      " triangles are wound against their neighbours and count as inverted");
  return remarks;
}

}  // namespace resilin
