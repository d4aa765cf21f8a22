#include "resilin/contact/contact_surface.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>

#include "resilin/contact/facing_area.hpp"
#include "resilin/mesh/facet.hpp"

namespace resilin {
namespace {

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

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
  FlatBody(ContactSurface& surface, const ContactBody& body, const VectorX& rest_positions,
           const Depth& depth)
      : surface_(surface), carrier_(body.carrier.get()) {
    const auto is_on_axis = [&](Index node) {
      return depth.is_on_axis(rest_positions[Eigen::Index{node} * surface.parts.dim]);
    };
    for (Index facet = 0; facet < body.facets.num_cells(); ++facet) {
      const std::span<const Index> nodes = body.facets.cell(facet);
      if (depth.is_turned && std::ranges::all_of(nodes, is_on_axis)) continue;
      const std::span<const Index> parts = flat_parts(body.facets.kind);
      Index middle = -1;
      for (const Index corner : parts) {
        if (corner < 0 && middle < 0) middle = add_middle(nodes);
        corners_.push_back(corner < 0 ? middle : vertex_of(nodes[static_cast<std::size_t>(corner)]));
      }
    }
  }
  Index num_vertices() const { return num_vertices_; }
  std::span<const Index> corners() const { return corners_; }

 private:
  Index vertex_of(Index point) {
    const auto [place, is_new] = vertex_of_point_.try_emplace(point, num_vertices_);
    if (!is_new) return place->second;
    if (carrier_ == nullptr) {
      append(point, 1);
    } else {
      carrier_->append_weights(point, surface_.vertices.nodes, surface_.vertices.shares);
    }
    return end_vertex(point);
  }
  Index add_middle(std::span<const Index> nodes) {
    assert(carrier_ == nullptr && "facets that are carried are lines and triangles");
    for (const Index node : nodes) append(node, 1.0 / static_cast<double>(nodes.size()));
    return end_vertex(nodes[0]);
  }
  /// To the row of the vertex that is being made.
  void append(Index node, double share) {
    surface_.vertices.nodes.push_back(node);
    surface_.vertices.shares.push_back(share);
  }
  Index end_vertex(Index number) {
    surface_.vertices.end_row();
    surface_.numbers.push_back(number);
    return num_vertices_++;
  }

  ContactSurface& surface_;
  const Embedding* carrier_;
  std::map<Index, Index> vertex_of_point_;
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
    const std::size_t num_corners = v[0] == v[1] ? 1 : v[1] == v[2] ? 2 : 3;
    for (std::size_t k = 0; k < num_corners; ++k) {
      --surface_.point_counts[static_cast<std::size_t>(v[k])];
    }
    const std::size_t num_edges = num_corners == 3 ? 3 : num_corners - 1;
    for (std::size_t k = 0; k < 3; ++k) {
      const Index edge = k < num_edges ? edge_between(parts, first_edge, v[k], v[(k + 1) % 3]) : -1;
      surface_.triangle_edges.push_back(edge);
      if (edge < 0) continue;
      surface_.edge_areas[static_cast<std::size_t>(edge)] += third;
      --surface_.edge_counts[static_cast<std::size_t>(edge)];
    }
  }
  void add_edge(std::size_t edge) {
    const CollisionSurface& parts = surface_.parts;
    const std::span<const Index> ends = std::span(parts.edges).subspan(2 * edge, 2);
    const double length = (place(ends[1]) - place(ends[0])).norm();
    surface_.edge_lengths[edge] = length;
    for (const Index end : ends.first(ends[0] == ends[1] ? 1 : 2))
      surface_.point_counts[static_cast<std::size_t>(end)] -= surface_.edge_counts[edge];
  }
  /// Where radii are known, of lengths.
  void find_means() {
    std::vector<double> counts(surface_.stiffness.size(), 0);
    surface_.mean_point_areas.assign(counts.size(), 0);
    for (std::size_t v = 0; v < surface_.point_areas.size(); ++v) {
      const std::size_t body = at(surface_.parts.bodies[v]);
      surface_.mean_point_areas[body] += surface_.point_areas[v];
      counts[body] += surface_.radii.empty() ? 1 : 2 * std::numbers::pi * surface_.radii[v];
    }
    for (std::size_t body = 0; body < counts.size(); ++body)
      if (counts[body] > 0) surface_.mean_point_areas[body] /= counts[body];
  }

 private:
  Vector3 place(Index vertex) const { return node_position(surface_.parts.dim, vertex, rest_); }

  ContactSurface& surface_;
  const VectorX& rest_;
};

}  // namespace

VectorX ContactSurface::places(const VectorX& x, const Conditions& c) const {
  VectorX y = displacements(x);
  if (!obstacle) return y;
  const RigidPlace place = obstacle->motion.place(c.time - c.delay);
  Eigen::Index next = Eigen::Index{num_body_vertices()} * parts.dim;
  for (const Vector3& X : obstacle->mesh.vertices) {
    y.segment(next, parts.dim) = place(X).head(parts.dim);
    next += parts.dim;
  }
  return y;
}

double ContactSurface::mean_area_beside(Index vertex, Index body) const {
  const double mean = mean_point_areas[at(body)];
  if (radii.empty()) return mean;
  // Beside the axis that of a point there.
  return mean * 2 * std::numbers::pi * std::max(radii[at(vertex)], mean / 3);
}

VectorX ContactSurface::displacements(const VectorX& x) const { return vertices.places(parts.dim, x); }

void ContactSurface::add_to_nodes(const VectorX& of_vertices, VectorX& of_nodes) const {
  for (Index v = 0; v < vertices.num_points(); ++v)
    vertices.add_to_nodes(parts.dim, v, node_position(parts.dim, v, of_vertices), of_nodes);
}

void ContactSurface::add_magnitudes_to_nodes(const VectorX& of_vertices, VectorX& of_nodes) const {
  for (Index v = 0; v < vertices.num_points(); ++v)
    vertices.add_magnitude_to_nodes(parts.dim, v, node_position(parts.dim, v, of_vertices), of_nodes);
}

void leave_held_out(ContactSurface& surface, std::span<const std::uint8_t> is_held) {
  CollisionSurface& parts = surface.parts;
  const auto is_out = [&](Index vertex) {
    const std::span<const Index> nodes = surface.vertices.nodes_of(vertex);
    return !nodes.empty() && std::ranges::all_of(nodes, [&](Index node) { return is_held[at(node)] != 0; });
  };
  std::erase_if(parts.points, is_out);
  std::vector<Index> new_numbers(surface.edge_lengths.size(), -1);
  std::size_t kept = 0;
  for (std::size_t edge = 0; edge < new_numbers.size(); ++edge) {
    if (is_out(parts.edges[2 * edge]) && is_out(parts.edges[2 * edge + 1])) continue;
    std::copy_n(&parts.edges[2 * edge], 2, &parts.edges[2 * kept]);
    surface.edge_lengths[kept] = surface.edge_lengths[edge];
    surface.edge_counts[kept] = surface.edge_counts[edge];
    for (std::vector<double>* values : {&surface.edge_areas, &surface.sharpness.edges})
      if (!values->empty()) (*values)[kept] = (*values)[edge];
    new_numbers[edge] = static_cast<Index>(kept++);
  }
  parts.edges.resize(2 * kept);
  surface.edge_lengths.resize(kept);
  surface.edge_counts.resize(kept);
  for (std::vector<double>* values : {&surface.edge_areas, &surface.sharpness.edges})
    if (!values->empty()) values->resize(kept);
  for (Index& edge : surface.triangle_edges)
    if (edge >= 0) edge = new_numbers[at(edge)];
  std::size_t end = 0;
  for (std::size_t t = 0; t < parts.triangles.size(); t += 3) {
    if (std::all_of(&parts.triangles[t], &parts.triangles[t] + 3, is_out)) continue;
    std::copy_n(&parts.triangles[t], 3, &parts.triangles[end]);
    std::copy_n(&surface.triangle_edges[t], 3, &surface.triangle_edges[end]);
    end += 3;
  }
  parts.triangles.resize(end);
  surface.triangle_edges.resize(end);
}

ContactSurface make_contact_surface(int dim, std::span<const ContactBody> bodies,
                                    const VectorX& rest_positions, std::optional<ContactObstacle> obstacle,
                                    const Depth& depth) {
  ContactSurface surface;
  surface.parts.dim = dim;
  std::vector<Index> first_edges;
  std::vector<std::size_t> first_triangles;
  const auto add = [&](Index num_vertices, std::span<const Index> corners, double stiffness) {
    first_edges.push_back(static_cast<Index>(surface.parts.edges.size() / 2));
    first_triangles.push_back(surface.parts.triangles.size() / 3);
    add_body(surface.parts, num_vertices, corners);
    surface.stiffness.push_back(stiffness);
  };
  for (const ContactBody& body : bodies) {
    const FlatBody flat(surface, body, rest_positions, depth);
    add(flat.num_vertices(), flat.corners(), body.stiffness);
  }
  if (obstacle) {
    const std::size_t count = obstacle->mesh.vertices.size();
    surface.vertices.row_begin.insert(surface.vertices.row_begin.end(), count, surface.vertices.nodes.size());
    for (std::size_t vertex = 0; vertex < count; ++vertex)
      surface.numbers.push_back(static_cast<Index>(vertex));
    add(static_cast<Index>(count), obstacle->mesh.facets, std::numeric_limits<double>::infinity());
    surface.obstacle = std::move(obstacle);
  }
  first_triangles.push_back(surface.parts.triangles.size() / 3);
  const std::size_t num_vertices = surface.parts.num_vertices(), num_edges = surface.parts.edges.size() / 2;
  surface.point_counts.assign(num_vertices, 1);
  surface.edge_areas.assign(dim == 3 ? num_edges : 0, 0);
  surface.edge_lengths.assign(num_edges, 0);
  surface.edge_counts.assign(num_edges, 1);
  const VectorX rest_places = surface.places(rest_positions);
  surface.point_areas = facing_areas(surface.parts, rest_places, depth);
  for (std::size_t v = 0; depth.is_turned && v < num_vertices; ++v)
    surface.radii.push_back(std::abs(rest_places[2 * static_cast<Eigen::Index>(v)]));
  Shares shares(surface, rest_places);
  for (std::size_t body = 0; body + 1 < first_triangles.size(); ++body)
    for (std::size_t t = first_triangles[body]; t < first_triangles[body + 1]; ++t)
      shares.add_triangle(t, first_edges[body]);
  for (std::size_t edge = 0; edge < num_edges; ++edge) shares.add_edge(edge);
  shares.find_means();
  surface.sharpness = sharpness_of(surface.parts, surface.triangle_edges, rest_places);
  if (depth.is_turned) turn_tips(surface.parts, rest_places, depth, surface.sharpness);
  return surface;
}

}  // namespace resilin
