#include "resilin/view/shown_surface.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

#include "resilin/core/parallel.hpp"
#include "resilin/element/catalog.hpp"
#include "resilin/mesh/topology.hpp"
#include "resilin/world/rigid_shape.hpp"

namespace resilin {
namespace {

constexpr std::size_t vertices_per_chunk = 4096;

/// Flat triangles of a facet, by positions in its list of nodes.
std::span<const std::array<int, 3>> pieces_of(CellKind kind) {
  static constexpr std::array<std::array<int, 3>, 1> triangle = {{{0, 1, 2}}};
  static constexpr std::array<std::array<int, 3>, 2> quadrilateral = {{{0, 1, 2}, {0, 2, 3}}};
  static constexpr std::array<std::array<int, 3>, 4> triangle6 = {
      {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}, {3, 4, 5}}};
  switch (kind) {
    case CellKind::triangle:
      return triangle;
    case CellKind::quadrilateral:
      return quadrilateral;
    case CellKind::triangle6:
      return triangle6;
    case CellKind::point:
    case CellKind::line:
    case CellKind::line3:
    case CellKind::tetrahedron:
    case CellKind::tetrahedron10:
    case CellKind::hexahedron:
    case CellKind::prism:
    case CellKind::pyramid:
      break;
  }
  return {};
}

/// The outline of a facet as a ring of nodes, by positions in its list of nodes.
std::span<const int> outline_of(CellKind kind) {
  static constexpr std::array<int, 4> corners = {0, 1, 2, 3};
  static constexpr std::array<int, 6> triangle6 = {0, 3, 1, 4, 2, 5};
  if (kind == CellKind::triangle6) return triangle6;
  return std::span(corners).first(static_cast<std::size_t>(num_corners(kind)));
}

/// Tetrahedra between the nodes of a cell, by positions in its list of nodes.
std::vector<std::array<int, 4>> tetrahedra_of(CellKind kind) {
  if (kind == CellKind::tetrahedron) return {{0, 1, 2, 3}};
  if (kind == CellKind::hexahedron)  // around the diagonal from 0 to 6
    return {{0, 6, 1, 2}, {0, 6, 2, 3}, {0, 6, 3, 7}, {0, 6, 7, 4}, {0, 6, 4, 5}, {0, 6, 5, 1}};
  if (kind != CellKind::tetrahedron10) return {};
  const auto middle = [edges = cell_edges(kind)](int a, int b) {
    const auto found = std::ranges::find_if(
        edges, [&](const auto& e) { return (e[0] == a && e[1] == b) || (e[0] == b && e[1] == a); });
    return 4 + static_cast<int>(found - edges.begin());
  };
  std::vector<std::array<int, 4>> all;
  for (int a = 0; a < 4; ++a)
    all.push_back({a, middle(a, (a + 1) % 4), middle(a, (a + 2) % 4), middle(a, (a + 3) % 4)});
  const int below = middle(0, 1), above = middle(2, 3);  // the diagonal of the octahedron between them
  const std::array<int, 4> ring = {middle(0, 2), middle(0, 3), middle(1, 3), middle(1, 2)};
  for (std::size_t i = 0; i < 4; ++i) all.push_back({below, above, ring[i], ring[(i + 1) % 4]});
  return all;
}

std::size_t num_nodes_of_cells(const World& world) {
  std::size_t count = 0;
  for (const Body& body : world.bodies) count += static_cast<std::size_t>(body.num_nodes);
  return count;
}

}  // namespace

ShownSurface::ShownSurface(const World& world, Inside inside) : dim_(world.dimension) {
  const bool with_inside =
      inside == Inside::shown_by_cuts && dim_ == 3 && num_nodes_of_cells(world) <= most_inside_vertices;
  for (std::size_t b = 0; b < world.bodies.size(); ++b) {
    const Body& body = world.bodies[b];
    if (body.rigid && body.rigid->is_region()) continue;  // its body shows it
    if (is_shown_by_skin(body)) {
      begin_part(body, b, Kind::skin);
      add_skin(body.skin);
      end_part();
    }
    begin_part(body, b, Kind::cells);
    add_cells(body, with_inside);
    end_part();
    if (body.rigid) carry_by_control_nodes(world, body);
  }
  normals_ = VertexNormals(triangles_, num_vertices_);
  rest_positions_.resize(static_cast<std::size_t>(num_vertices_) * 3);
  positions(world.rest_positions, rest_positions_);
  for (std::size_t p = 0; p < parts_.size(); ++p)
    std::ranges::copy(sources_[p].own_rest,
                      rest_positions_.begin() + std::ptrdiff_t{3} * parts_[p].first_vertex);
}

void ShownSurface::begin_part(const Body& body, std::size_t number, Kind kind) {
  parts_.push_back({.name = body.name,
                    .body = number,
                    .kind = kind,
                    .first_vertex = num_vertices_,
                    .first_triangle = static_cast<Index>(triangles_.size()),
                    .first_edge = static_cast<Index>(edges_.size()),
                    .first_tetrahedron = static_cast<Index>(tetrahedra_.size())});
  sources_.emplace_back();
}

void ShownSurface::end_part() {
  Part& part = parts_.back();
  part.num_vertices = num_vertices_ - part.first_vertex;
  part.num_triangles = static_cast<Index>(triangles_.size()) - part.first_triangle;
  part.num_edges = static_cast<Index>(edges_.size()) - part.first_edge;
  part.num_tetrahedra = static_cast<Index>(tetrahedra_.size()) - part.first_tetrahedron;
}

void ShownSurface::add_skin(const std::shared_ptr<const Skin>& skin) {
  Source& source = sources_.back();
  source.carrier = std::shared_ptr<const Embedding>(skin, &skin->embedding);
  for (const double x : skin->rest_positions) source.own_rest.push_back(static_cast<float>(x));
  const auto first = static_cast<std::uint32_t>(num_vertices_);
  const auto vertex = [&](Index i) { return first + static_cast<std::uint32_t>(i); };
  for (Index f = 0; f < skin->facets.num_cells(); ++f) {
    const auto nodes = skin->facets.cell(f);
    if (nodes.size() == 2) {
      edges_.push_back({vertex(nodes[0]), vertex(nodes[1])});
    } else {
      triangles_.push_back({vertex(nodes[0]), vertex(nodes[1]), vertex(nodes[2])});
    }
  }
  num_vertices_ += skin->num_vertices();
}

/// Vertices are the facets' nodes in rising order, then those inside.
void ShownSurface::add_cells(const Body& body, bool with_inside) {
  const bool is_rigid = body.rigid != nullptr;
  const CellKind kind = is_rigid ? body.rigid->body.cell_kind : body.cell_kind;
  const SharedIndices& cells = is_rigid ? body.rigid->body.cells : body.cells;
  const Index first_node = is_rigid ? 0 : body.first_node;
  const CellBlock facets = visible_facets({kind, cells}).facets;
  const auto without_doubles = [](std::vector<Index> all) {
    std::ranges::sort(all);
    all.erase(std::ranges::unique(all).begin(), all.end());
    return all;
  };
  std::vector<Index>& nodes = sources_.back().nodes;
  nodes = without_doubles(facets.nodes);
  if (with_inside) {
    std::vector<Index> inside;
    std::ranges::set_difference(without_doubles(cells), nodes, std::back_inserter(inside));
    parts_.back().num_inside = static_cast<Index>(inside.size());
    nodes.insert(nodes.end(), inside.begin(), inside.end());
  }
  std::vector<std::uint32_t> vertex_of(
      static_cast<std::size_t>(is_rigid ? body.rigid->body.num_nodes : body.num_nodes));
  for (std::size_t i = 0; i < nodes.size(); ++i)
    vertex_of[static_cast<std::size_t>(nodes[i] - first_node)] =
        static_cast<std::uint32_t>(num_vertices_) + static_cast<std::uint32_t>(i);

  std::vector<Edge> edges;
  for (Index f = 0; f < facets.num_cells(); ++f) {
    const auto facet = facets.cell(f);
    const auto vertex = [&](int i) {
      return vertex_of[static_cast<std::size_t>(facet[static_cast<std::size_t>(i)] - first_node)];
    };
    for (const auto& [a, b, c] : pieces_of(facets.kind))
      triangles_.push_back({vertex(a), vertex(b), vertex(c)});
    const auto outline = outline_of(facets.kind);
    for (std::size_t i = 0; i < outline.size(); ++i) {
      const std::uint32_t a = vertex(outline[i]), b = vertex(outline[(i + 1) % outline.size()]);
      edges.push_back({std::min(a, b), std::max(a, b)});
    }
  }
  std::ranges::sort(edges);
  edges.erase(std::ranges::unique(edges).begin(), edges.end());
  edges_.insert(edges_.end(), edges.begin(), edges.end());
  if (with_inside) {
    const auto width = static_cast<std::size_t>(num_nodes(kind));
    const std::vector<std::array<int, 4>> pieces = tetrahedra_of(kind);
    for (std::size_t cell = 0; cell < cells.size(); cell += width)
      for (const auto& corners : pieces) {
        Tetrahedron& made = tetrahedra_.emplace_back();
        for (std::size_t i = 0; i < 4; ++i) {
          const Index node = cells[cell + static_cast<std::size_t>(corners[i])];
          made[i] = vertex_of[static_cast<std::size_t>(node - first_node)];
        }
      }
  }
  num_vertices_ += static_cast<Index>(nodes.size());
}

void ShownSurface::carry_by_control_nodes(const World& world, const Body& body) {
  Source& source = sources_.back();
  std::vector<Vector3> points;
  for (const Index vertex : source.nodes)
    points.push_back(body.rigid->mesh.vertices[static_cast<std::size_t>(vertex)]);
  source.carrier = std::make_shared<const Embedding>(require_element(body.element, dim_, body.name),
                                                     body.cells, world.rest_positions, points);
  for (const Vector3& X : points)
    for (const double x : X) source.own_rest.push_back(static_cast<float>(x));
  source.nodes.clear();
  points.resize(points.size() - static_cast<std::size_t>(parts_.back().num_inside));
  for (Index node = body.first_node; node < body.first_node + body.num_nodes; ++node) {
    const Vector3 X = node_position(dim_, node, world.rest_positions);
    const auto nearest =
        std::ranges::min_element(points, {}, [&](const Vector3& point) { return (point - X).norm(); });
    source.nearest[node] = static_cast<Index>(nearest - points.begin());
  }
}

void ShownSurface::positions(const VectorX& x, std::span<float> out) const {
  for (std::size_t p = 0; p < parts_.size(); ++p) {
    const auto part = out.subspan(3 * static_cast<std::size_t>(parts_[p].first_vertex),
                                  3 * static_cast<std::size_t>(parts_[p].num_vertices));
    if (sources_[p].carrier) {
      sources_[p].carrier->apply(x, part);
      continue;
    }
    const std::vector<Index>& nodes = sources_[p].nodes;
    parallel_for(nodes.size(), vertices_per_chunk, [&](std::size_t begin, std::size_t end) {
      for (std::size_t v = begin; v < end; ++v) {
        const double* place = x.data() + Eigen::Index{nodes[v]} * dim_;
        part[3 * v] = static_cast<float>(place[0]);
        part[3 * v + 1] = static_cast<float>(place[1]);
        part[3 * v + 2] = dim_ == 3 ? static_cast<float>(place[2]) : 0.0F;
      }
    });
  }
}

void ShownSurface::interpolate(std::span<const double> nodal_values, std::span<float> out) const {
  for (std::size_t p = 0; p < parts_.size(); ++p) {
    const auto part = out.subspan(static_cast<std::size_t>(parts_[p].first_vertex),
                                  static_cast<std::size_t>(parts_[p].num_vertices));
    if (sources_[p].carrier) {
      sources_[p].carrier->interpolate(nodal_values, part);
      continue;
    }
    for (std::size_t v = 0; v < part.size(); ++v)
      part[v] = static_cast<float>(nodal_values[static_cast<std::size_t>(sources_[p].nodes[v])]);
  }
}

MaterialPoint ShownSurface::material_point(Index vertex) const {
  const auto after = std::ranges::find_if(
      parts_, [&](const Part& part) { return vertex < part.first_vertex + part.num_vertices; });
  const Index local = vertex - after->first_vertex;
  const Source& source = sources_[static_cast<std::size_t>(after - parts_.begin())];
  if (!source.carrier) return {{source.nodes[static_cast<std::size_t>(local)]}, {1.0}};
  const auto nodes = source.carrier->nodes(local);
  const auto weights = source.carrier->weights(local);
  return {{nodes.begin(), nodes.end()}, {weights.begin(), weights.end()}};
}

std::optional<Index> ShownSurface::vertex_of(Index node) const {
  for (std::size_t p = 0; p < parts_.size(); ++p) {
    if (const auto nearest = sources_[p].nearest.find(node); nearest != sources_[p].nearest.end())
      return parts_[p].first_vertex + nearest->second;
    if (sources_[p].carrier) continue;  // its vertices are no nodes
    const auto& nodes = sources_[p].nodes;
    const auto inside = nodes.end() - parts_[p].num_inside;  // both halves rise
    for (const auto& [begin, end] : {std::pair(nodes.begin(), inside), std::pair(inside, nodes.end())}) {
      const auto found = std::lower_bound(begin, end, node);
      if (found != end && *found == node)
        return parts_[p].first_vertex + static_cast<Index>(found - nodes.begin());
    }
  }
  return std::nullopt;
}

bool ShownSurface::is_outside(Index vertex) const {
  return std::ranges::none_of(parts_, [vertex](const Part& part) {
    const Index end = part.first_vertex + part.num_vertices;
    return vertex >= end - part.num_inside && vertex < end;
  });
}

ShownSurface::Touch ShownSurface::touch(Index vertex, const Vector3& place,
                                        std::span<const float> positions) const {
  const auto at = [&](std::uint32_t v) -> Vector3 {
    return Eigen::Map<const Eigen::Vector3f>(positions.data() + 3 * std::size_t{v}).cast<double>();
  };
  const auto wanted = static_cast<std::uint32_t>(vertex);
  Touch touched;
  touched.corners = {wanted, wanted, wanted};
  double nearest = (at(wanted) - place).norm();
  for (std::size_t t = 0; t < triangles_.size(); ++t) {
    const Triangle& triangle = triangles_[t];
    if (std::ranges::find(triangle, wanted) == triangle.end()) continue;
    const Vector3 A = at(triangle[0]), u = at(triangle[1]) - A, v = at(triangle[2]) - A;
    const double uu = u.squaredNorm(), uv = u.dot(v), vv = v.squaredNorm(), area = uu * vv - uv * uv;
    if (!(area > 0)) continue;
    const double b = (vv * u.dot(place - A) - uv * v.dot(place - A)) / area;
    const double c = (uu * v.dot(place - A) - uv * u.dot(place - A)) / area;
    Vector3 weights = Vector3(1 - b - c, b, c).cwiseMax(0);
    weights /= weights.sum();
    const double distance = (A + weights[1] * u + weights[2] * v - place).norm();
    if (distance >= nearest) continue;
    nearest = distance;
    touched = {.triangle = t, .corners = triangle, .shares = {weights[0], weights[1], weights[2]}};
  }
  return touched;
}

MaterialPoint ShownSurface::touched_place(Index vertex, const Vector3& place,
                                          std::span<const float> positions) const {
  const Touch touched_at = touch(vertex, place, positions);
  MaterialPoint touched;
  for (std::size_t i = 0; i < 3; ++i) {
    const double share = touched_at.shares[i];
    if (share == 0) continue;
    const MaterialPoint corner = material_point(static_cast<Index>(touched_at.corners[i]));
    for (std::size_t a = 0; a < corner.nodes.size(); ++a) {
      touched.nodes.push_back(corner.nodes[a]);
      touched.weights.push_back(share * corner.weights[a]);
    }
  }
  return touched;
}

Index ShownSurface::nearest_node(Index vertex) const {
  const MaterialPoint point = material_point(vertex);
  return point
      .nodes[static_cast<std::size_t>(std::ranges::max_element(point.weights) - point.weights.begin())];
}

}  // namespace resilin
