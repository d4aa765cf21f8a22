#include "resilin/picture/surface.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "resilin/mesh/cell_kind.hpp"
#include "resilin/mesh/topology.hpp"

namespace resilin {
namespace {

constexpr int pieces = 6;  // pieces of a side of a facet that may be curved
const double crease_cosine = std::cos(40 * std::numbers::pi / 180);

struct Facet {
  CellKind kind;
  std::span<const Index> nodes;
  Index cell;
  Vector3 normal;  ///< normal of the corners, of length 1
};

Vector3 normal_of(std::span<const Index> corners, const std::vector<Vector3>& points) {
  const auto at = [&](std::size_t i) -> const Vector3& {
    return points[static_cast<std::size_t>(corners[i])];
  };
  const Vector3 area = corners.size() == 3 ? Vector3((at(1) - at(0)).cross(at(2) - at(0)))
                                           : Vector3((at(2) - at(0)).cross(at(3) - at(1)));
  const double size = area.norm();
  return size > 0 ? Vector3(area / size) : Vector3(Vector3::UnitZ());
}

/// For a quadratic triangle (corners 0, 1, 2; middles 3 of 0-1, 4 of 1-2, 5 of 2-0), which its middles cut
/// into four; `L` are barycentric coordinates.
std::array<double, max_facet_nodes> shares_of_parts(const std::array<double, 3>& L) {
  std::array<double, max_facet_nodes> shares{};
  for (std::size_t a = 0; a < 3; ++a) {
    if (L[a] < 0.5) continue;
    shares[a] = 2 * L[a] - 1;
    shares[3 + a] = 2 * L[(a + 1) % 3];
    shares[3 + (a + 2) % 3] = 2 * L[(a + 2) % 3];
    return shares;
  }
  for (std::size_t a = 0; a < 3; ++a) shares[3 + a] = 1 - 2 * L[(a + 2) % 3];
  return shares;
}

/// Collects facets and cuts them up.
class SurfaceBuilder {
 public:
  SurfaceBuilder(const std::vector<CellBlock>& blocks, const std::vector<Vector3>& points, bool has_skins)
      : points_(points) {
    if (has_skins) surface_.dimension = 3;
    for (const CellBlock& block : blocks)
      surface_.dimension = std::max(surface_.dimension, dimension(block.kind));
    Index first_cell = 0;
    boundaries_.reserve(blocks.size());
    for (const CellBlock& block : blocks) {
      const bool is_skin = has_skins && block.kind == CellKind::triangle;
      if (is_skin || is_solid(block.kind, surface_.dimension)) add_facets(block, first_cell);
      first_cell += block.num_cells();
    }
  }

  DrawnSurface build() {
    for (std::size_t f = 0; f < facets_.size(); ++f) {
      const std::vector<Vector3> normals = corner_normals(f);
      add_triangles(facets_[f], normals);
      add_edges(f, normals);
    }
    for (auto& [corners, edge] : edges_) {
      const bool is_border = edge.facets.size() == 1;
      const bool is_crease = edge.facets.size() == 2 && facets_[edge.facets[0]].normal.dot(
                                                            facets_[edge.facets[1]].normal) < crease_cosine;
      surface_.edges.push_back({std::move(edge.points), is_border || is_crease});
    }
    return std::move(surface_);
  }

 private:
  struct Edge {
    std::vector<std::size_t> facets;
    std::vector<DrawnSurface::Corner> points;
  };

  void add_facets(const CellBlock& block, Index first_cell) {
    Boundary visible = visible_facets(block);
    const CellBlock& facets = boundaries_.emplace_back(std::move(visible.facets));
    for (Index f = 0; f < facets.num_cells(); ++f) {
      const std::span<const Index> nodes = facets.cell(f);
      const auto corners = nodes.first(static_cast<std::size_t>(num_corners(facets.kind)));
      const Index cell = visible.owners[static_cast<std::size_t>(f)].cell;
      for (const Index corner : corners) facets_at_[corner].push_back(facets_.size());
      facets_.push_back({facets.kind, nodes, first_cell + cell, normal_of(corners, points_)});
    }
  }

  /// At each corner the mean over the facets there that are not across a crease.
  std::vector<Vector3> corner_normals(std::size_t f) const {
    const Facet& facet = facets_[f];
    std::vector<Vector3> normals;
    for (int corner = 0; corner < num_corners(facet.kind); ++corner) {
      Vector3 sum = Vector3::Zero();
      for (const std::size_t other : facets_at_.at(facet.nodes[static_cast<std::size_t>(corner)]))
        if (facets_[other].normal.dot(facet.normal) >= crease_cosine) sum += facets_[other].normal;
      normals.push_back(sum.normalized());
    }
    return normals;
  }

  DrawnSurface::Corner corner_at(const Facet& facet, const std::vector<Vector3>& normals, double xi,
                                 double eta) const {
    DrawnSurface::Corner corner{.cell = facet.cell, .num_nodes = static_cast<int>(facet.nodes.size())};
    std::ranges::copy(facet.nodes, corner.nodes.begin());
    element_of_cells(facet.kind)
        ->shape_values({xi, eta, 0}, std::span(corner.shares).first(facet.nodes.size()));
    corner.part_shares =
        facet.kind == CellKind::triangle6 ? shares_of_parts({1 - xi - eta, xi, eta}) : corner.shares;
    std::array<double, max_facet_nodes> N{};
    element_of_cells(first_order(facet.kind))->shape_values({xi, eta, 0}, std::span(N).first(normals.size()));
    for (std::size_t a = 0; a < normals.size(); ++a) corner.normal += N[a] * normals[a];
    if (corner.normal.norm() > 0) corner.normal.normalize();
    return corner;
  }

  /// A grid of n x n places; triangles have those below the diagonal.
  void add_triangles(const Facet& facet, const std::vector<Vector3>& normals) {
    const bool is_quadrilateral = first_order(facet.kind) == CellKind::quadrilateral;
    const int n = facet.kind == CellKind::triangle ? 1 : pieces;
    const auto at = [&](int i, int j) {
      return corner_at(facet, normals, static_cast<double>(i) / n, static_cast<double>(j) / n);
    };
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < (is_quadrilateral ? n : n - j); ++i) {
        surface_.triangles.push_back({at(i, j), at(i + 1, j), at(i, j + 1)});
        if (is_quadrilateral || i + j < n - 1)
          surface_.triangles.push_back({at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)});
      }
  }

  void add_edges(std::size_t f, const std::vector<Vector3>& normals) {
    const Facet& facet = facets_[f];
    const std::span<const Vector3> places = element_of_cells(facet.kind)->nodes;
    const int count = num_corners(facet.kind);
    const int n = is_second_order(facet.kind) ? pieces : 1;
    for (int corner = 0; corner < count; ++corner) {
      const auto a = static_cast<std::size_t>(corner), b = static_cast<std::size_t>((corner + 1) % count);
      Edge& edge =
          edges_[{std::min(facet.nodes[a], facet.nodes[b]), std::max(facet.nodes[a], facet.nodes[b])}];
      edge.facets.push_back(f);
      if (!edge.points.empty()) continue;
      for (int i = 0; i <= n; ++i) {
        const double t = static_cast<double>(i) / n;
        const Vector3 xi = (1 - t) * places[a] + t * places[b];
        edge.points.push_back(corner_at(facet, normals, xi.x(), xi.y()));
      }
    }
  }

  const std::vector<Vector3>& points_;
  std::vector<CellBlock> boundaries_;  ///< cells seen by the views of the facets
  std::vector<Facet> facets_;
  std::map<Index, std::vector<std::size_t>> facets_at_;  ///< by corner
  std::map<std::array<Index, 2>, Edge> edges_;           ///< by corners
  DrawnSurface surface_{.dimension = 2, .triangles = {}, .edges = {}};
};

}  // namespace

DrawnSurface find_surface(const std::vector<CellBlock>& blocks, const std::vector<Vector3>& points,
                          bool has_skins) {
  return SurfaceBuilder(blocks, points, has_skins).build();
}

}  // namespace resilin
