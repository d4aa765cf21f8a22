#include "resilin/contact/contact_surface.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <map>

#include "resilin/mesh/facet.hpp"

namespace resilin {
namespace {

/// The corners of the flat parts of a facet, by its nodes; -1 is its middle.
std::span<const Index> flat_parts(CellKind kind) {
  static constexpr std::array<Index, 2> line = {0, 1};
  static constexpr std::array<Index, 4> line3 = {0, 2, 2, 1};
  static constexpr std::array<Index, 3> triangle = {0, 1, 2};
  static constexpr std::array<Index, 12> triangle6 = {0, 3, 5, 3, 1, 4, 5, 4, 2, 3, 4, 5};
  static constexpr std::array<Index, 12> quadrilateral = {0, 1, -1, 1, 2, -1, 2, 3, -1, 3, 0, -1};
  switch (kind) {
    case CellKind::line:
      return line;
    case CellKind::line3:
      return line3;
    case CellKind::triangle:
      return triangle;
    case CellKind::triangle6:
      return triangle6;
    case CellKind::quadrilateral:
      return quadrilateral;
    default:
      return {};
  }
}

/// One body's flat parts, by its own vertices.
class FlatBody {
 public:
  FlatBody(ContactSurface& surface, const CellBlock& facets) : surface_(surface) {
    for (Index facet = 0; facet < facets.num_cells(); ++facet) {
      const std::span<const Index> nodes = facets.cell(facet);
      const std::span<const Index> parts = flat_parts(facets.kind);
      Index middle = -1;
      for (const Index corner : parts) {
        if (corner < 0 && middle < 0) middle = add_vertex(nodes);
        corners_.push_back(corner < 0 ? middle : vertex_of(nodes[static_cast<std::size_t>(corner)]));
      }
    }
  }
  Index num_vertices() const { return num_vertices_; }
  std::span<const Index> corners() const { return corners_; }

 private:
  Index vertex_of(const Index& node) {
    const auto [place, is_new] = vertex_of_node_.try_emplace(node, num_vertices_);
    if (is_new) add_vertex({&node, 1});
    return place->second;
  }
  Index add_vertex(std::span<const Index> nodes) {
    surface_.nodes.insert(surface_.nodes.end(), nodes.begin(), nodes.end());
    surface_.shares.insert(surface_.shares.end(), nodes.size(), 1.0 / static_cast<double>(nodes.size()));
    surface_.row_begin.push_back(surface_.nodes.size());
    return num_vertices_++;
  }

  ContactSurface& surface_;
  std::map<Index, Index> vertex_of_node_;
  std::vector<Index> corners_;
  Index num_vertices_ = 0;
};

/// The number of an edge among those from `first_edge` on, which are in rising order.
Index edge_between(const CollisionSurface& parts, Index first_edge, Index a, Index b) {
  const std::array<Index, 2> wanted = {std::min(a, b), std::max(a, b)};
  Index low = first_edge, high = static_cast<Index>(parts.edges.size() / 2);
  while (low < high) {
    const Index middle = low + (high - low) / 2;
    const auto at = static_cast<std::size_t>(2 * middle);
    if (std::array{parts.edges[at], parts.edges[at + 1]} < wanted)
      low = middle + 1;
    else
      high = middle;
  }
  return low;
}

/// Areas, and how often distances to edges and vertices count: 1 less those of the parts that they are part
/// of, so that each simplex of a closed surface counts once in all.
class Shares {
 public:
  Shares(ContactSurface& surface, const VectorX& rest_places) : surface_(surface), rest_(rest_places) {}

  void add_triangle(std::size_t triangle, Index first_edge) {
    const CollisionSurface& parts = surface_.parts;
    const std::span<const Index> v = std::span(parts.triangles).subspan(3 * triangle, 3);
    const Vector3 a = place(v[0]), b = place(v[1]), c = place(v[2]);
    const double third = (b - a).cross(c - a).norm() / 6;
    for (std::size_t k = 0; k < 3; ++k) {
      const Index edge = edge_between(parts, first_edge, v[k], v[(k + 1) % 3]);
      surface_.triangle_edges.push_back(edge);
      surface_.edge_areas[static_cast<std::size_t>(edge)] += third;
      surface_.point_areas[static_cast<std::size_t>(v[k])] += third;
      --surface_.edge_counts[static_cast<std::size_t>(edge)];
      --surface_.point_counts[static_cast<std::size_t>(v[k])];
    }
  }
  void add_edge(std::size_t edge) {
    const CollisionSurface& parts = surface_.parts;
    const Index v[] = {parts.edges[2 * edge], parts.edges[2 * edge + 1]};
    const double length = (place(v[1]) - place(v[0])).norm();
    surface_.edge_lengths[edge] = length;
    for (const Index end : v) {
      surface_.point_counts[static_cast<std::size_t>(end)] -= surface_.edge_counts[edge];
      if (parts.dim == 2) surface_.point_areas[static_cast<std::size_t>(end)] += length / 2;
    }
  }

 private:
  Vector3 place(Index vertex) const { return node_position(surface_.parts.dim, vertex, rest_); }

  ContactSurface& surface_;
  const VectorX& rest_;
};

}  // namespace

VectorX ContactSurface::places(const VectorX& x) const {
  const Eigen::Index dim = parts.dim;
  VectorX y(static_cast<Eigen::Index>(parts.num_vertices()) * dim);
  for (std::size_t v = 0; v < parts.num_vertices(); ++v) {
    auto place = y.segment(static_cast<Eigen::Index>(v) * dim, dim);
    place.setZero();
    for (std::size_t k = row_begin[v]; k < row_begin[v + 1]; ++k)
      place += shares[k] * x.segment(nodes[k] * dim, dim);
  }
  return y;
}

void ContactSurface::add_to_nodes(const VectorX& of_vertices, VectorX& of_nodes) const {
  const Eigen::Index dim = parts.dim;
  for (std::size_t v = 0; v < parts.num_vertices(); ++v)
    for (std::size_t k = row_begin[v]; k < row_begin[v + 1]; ++k)
      of_nodes.segment(nodes[k] * dim, dim) +=
          shares[k] * of_vertices.segment(static_cast<Eigen::Index>(v) * dim, dim);
}

ContactSurface make_contact_surface(int dim, std::span<const ContactBody> bodies,
                                    const VectorX& rest_positions) {
  ContactSurface surface;
  surface.parts.dim = dim;
  std::vector<Index> first_edges;
  std::vector<std::size_t> first_triangles;
  for (const ContactBody& body : bodies) {
    first_edges.push_back(static_cast<Index>(surface.parts.edges.size() / 2));
    first_triangles.push_back(surface.parts.triangles.size() / 3);
    const FlatBody flat(surface, body.facets);
    add_body(surface.parts, flat.num_vertices(), flat.corners());
    surface.stiffness.push_back(body.stiffness);
  }
  first_triangles.push_back(surface.parts.triangles.size() / 3);
  const std::size_t num_vertices = surface.parts.num_vertices(), num_edges = surface.parts.edges.size() / 2;
  surface.point_areas.assign(num_vertices, 0);
  surface.point_counts.assign(num_vertices, 1);
  surface.edge_areas.assign(dim == 3 ? num_edges : 0, 0);
  surface.edge_lengths.assign(num_edges, 0);
  surface.edge_counts.assign(num_edges, 1);
  const VectorX rest_places = surface.places(rest_positions);
  Shares shares(surface, rest_places);
  for (std::size_t body = 0; body < bodies.size(); ++body)
    for (std::size_t t = first_triangles[body]; t < first_triangles[body + 1]; ++t)
      shares.add_triangle(t, first_edges[body]);
  for (std::size_t edge = 0; edge < num_edges; ++edge) shares.add_edge(edge);
  return surface;
}

}  // namespace resilin
