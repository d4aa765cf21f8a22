#include "resilin/world/selection.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>

#include "resilin/core/error.hpp"
#include "resilin/core/text.hpp"
#include "resilin/mesh/facet.hpp"
#include "resilin/mesh/second_order.hpp"
#include "resilin/mesh/topology.hpp"
#include "resilin/world/description_check.hpp"
#include "resilin/world/facet_faces.hpp"

namespace resilin {
namespace {

/// The body's cells with its own vertex numbers.
CellBlock local_cells(const Body& body) {
  CellBlock block{.kind = body.cell_kind, .nodes = body.cells};
  for (Index& node : block.nodes) node -= body.first_node;
  return block;
}

std::vector<std::string> group_names(const Mesh& mesh) {
  std::vector<std::string> names;
  for (const Group& group : mesh.groups) names.push_back(group.name);
  return names;
}

std::function<bool(const Vector3&)> position_test(const Where& where, double extent) {
  switch (where.kind) {
    case Where::Kind::box:
      return [&where](const Vector3& X) {
        return (X.array() >= where.min.array()).all() && (X.array() <= where.max.array()).all();
      };
    case Where::Kind::plane:
      return [&where, extent](const Vector3& X) {
        return std::abs(X[where.axis] - where.at) <= where.tolerance.value_or(1e-6 * extent);
      };
    case Where::Kind::sphere:
      return [&where](const Vector3& X) { return (X - where.center).norm() <= where.radius; };
    default:
      return [](const Vector3&) { return true; };
  }
}

void check_where(const Where& where, int dim, const std::string& place) {
  switch (where.kind) {
    case Where::Kind::plane:
      require_axis(where.axis, dim, place + ".plane.axis");
      [[fallthrough]];
    case Where::Kind::all:
    case Where::Kind::group:
    case Where::Kind::box:
    case Where::Kind::sphere:
    case Where::Kind::vertices:
    case Where::Kind::face:
      if (where.normal && where.normal->head(dim).norm() == 0)
        throw InputError(place + ".normal", "a direction", "a vector without length");
      return;
  }
  throw InputError(place, "a kind of selection",
                   "the number " + std::to_string(static_cast<int>(where.kind)));
}

/// "the body reaches from x = 0 to 4, y = 0 to 1", to help when nothing was selected.
std::string describe_extent(const Body& body, const VectorX& rest_positions, int dim) {
  std::string text = "the body reaches from ";
  for (int k = 0; k < dim; ++k) {
    const Reach reach = reach_along(k, body, rest_positions, dim);
    if (k > 0) text += ", ";
    text += std::string(1, "xyz"[k]) + " = " + format_number(reach.low) + " to " + format_number(reach.high);
  }
  return text;
}

std::vector<bool> flags_of(const std::vector<Index>& vertices, const Body& body) {
  std::vector<bool> flags(static_cast<std::size_t>(body.num_nodes), false);
  for (const Index v : vertices) flags[static_cast<std::size_t>(v)] = true;
  return flags;
}

/// The facets of the face at a point, a flag for each facet of the surface.
///
/// The skin of a body says better than its cells which facets make up a face: cells may be coarse, or stand
/// out of the skin. A facet is then of the face of the skin's triangle that is nearest to its centroid.
std::vector<bool> facets_of_face(const Where& where, const FacetFaces& surface, const Body& body,
                                 double extent, const std::string& place) {
  constexpr double far_off = 0.05;  // distance relative to the extent
  const auto require_near = [&](double distance) {
    if (distance > far_off * extent)
      throw InputError(place + ".face_at", "a point on the surface of the body",
                       "a point " + format_short(distance) + " m off it");
  };
  const bool is_by_skin =
      body.skin != nullptr && dimension(body.skin->facets.kind) == 2 && dimension(surface.facets().kind) == 2;
  if (!is_by_skin) {
    const FacetFaces::Nearest nearest = surface.nearest(std::array{where.face_at}).front();
    require_near(nearest.distance);
    return surface.face_of(nearest.facet, where.angle);
  }
  const FacetFaces skin(3, body.skin->facets, body.skin->rest_positions);
  const FacetFaces::Nearest nearest = skin.nearest(std::array{where.face_at}).front();
  require_near(nearest.distance);
  const std::vector<bool> face = skin.face_of(nearest.facet, where.angle);
  std::vector<Vector3> centroids;
  for (Index facet = 0; facet < surface.count(); ++facet) centroids.push_back(surface.centroid(facet));
  std::vector<bool> is_meant;
  for (const FacetFaces::Nearest& on_skin : skin.nearest(centroids)) {
    const auto facet = static_cast<Index>(is_meant.size());
    is_meant.push_back(face[static_cast<std::size_t>(on_skin.facet)] &&
                       skin.normal(on_skin.facet).dot(surface.normal(facet)) > 0);
  }
  return is_meant;
}

/// Nodes, in the world's numbering, of the cells of a block whose nodes are all selected.
std::vector<Index> whole_cells(const CellBlock& block, const std::vector<Index>& selected_vertices,
                               const Body& body) {
  const std::vector<bool> is_selected = flags_of(selected_vertices, body);
  std::vector<Index> nodes;
  for (Index cell = 0; cell < block.num_cells(); ++cell) {
    const std::span<const Index> local = block.cell(cell);
    if (!std::ranges::all_of(local, [&](Index v) { return is_selected[static_cast<std::size_t>(v)]; }))
      continue;
    for (const Index v : local) nodes.push_back(body.first_node + v);
  }
  nodes.shrink_to_fit();
  return nodes;
}

}  // namespace

const Group& find_group(const Mesh& mesh, const std::string& name, const std::string& place) {
  if (const Group* group = mesh.find_group(name)) return *group;
  const std::vector<std::string> names = group_names(mesh);
  if (names.empty()) {
    throw InputError(place, "a group of the mesh", "\"" + name + "\"",
                     "the mesh has no groups: use box, plane, sphere or vertices");
  }
  throw InputError(place, "a group of the mesh (" + join(names) + ")", "\"" + name + "\"",
                   did_you_mean(name, names));
}

std::function<bool(const Vector3&)> place_test(const Where& where, int dim, double extent,
                                               const std::string& place) {
  check_where(where, dim, place);
  return position_test(where, extent);
}

std::vector<Index> select_vertices(const Where& where, const Mesh& mesh, const Body& body,
                                   const VectorX& rest_positions, int dim, const std::string& place) {
  check_where(where, dim, place);
  std::vector<bool> is_candidate(static_cast<std::size_t>(body.num_nodes),
                                 where.kind != Where::Kind::group && where.kind != Where::Kind::vertices);
  if (where.kind == Where::Kind::group) {
    for (const Index v : find_group(mesh, where.group, place).vertices)
      is_candidate[static_cast<std::size_t>(v)] = true;
  }
  if (where.kind == Where::Kind::vertices) {
    for (const Index v : where.vertices) {
      if (v < 0 || v >= body.num_vertices) {
        throw InputError(place, "vertex numbers from 0 to " + std::to_string(body.num_vertices - 1),
                         std::to_string(v));
      }
      is_candidate[static_cast<std::size_t>(v)] = true;
    }
    if (is_second_order(body.cell_kind)) {
      for (const Index v : middles_between(local_cells(body), is_candidate))
        is_candidate[static_cast<std::size_t>(v)] = true;
    }
  }
  const std::vector<bool> is_used = used_vertices(local_cells(body), body.num_nodes);
  const auto is_inside = position_test(where, largest_extent(body, rest_positions, dim));
  std::vector<Index> selected;
  for (Index v = 0; v < body.num_nodes; ++v) {
    const auto i = static_cast<std::size_t>(v);
    if (is_candidate[i] && is_used[i] && is_inside(node_position(dim, body.first_node + v, rest_positions))) {
      selected.push_back(v);
    }
  }
  if (where.means_facets()) {
    const CellBlock surface = boundary(local_cells(body)).facets;
    const std::vector<bool> is_meant = meant_facets(where, selected, body, rest_positions, dim, place);
    std::vector<bool> is_of_them(static_cast<std::size_t>(body.num_nodes), false);
    for (Index facet = 0; facet < surface.num_cells(); ++facet)
      if (is_meant[static_cast<std::size_t>(facet)])
        for (const Index v : surface.cell(facet)) is_of_them[static_cast<std::size_t>(v)] = true;
    std::erase_if(selected, [&](Index v) { return !is_of_them[static_cast<std::size_t>(v)]; });
  }
  if (selected.empty()) {
    throw InputError(place, "a selection with at least one vertex", "none",
                     where.normal ? "no facet there has such a normal; `angle` [degrees] lets more in"
                                  : describe_extent(body, rest_positions, dim));
  }
  return selected;
}

std::vector<bool> meant_facets(const Where& where, const std::vector<Index>& selected_vertices,
                               const Body& body, const VectorX& rest_positions, int dim,
                               const std::string& place) {
  const CellBlock surface = boundary(local_cells(body)).facets;
  const std::vector<bool> is_selected = flags_of(selected_vertices, body);
  std::vector<bool> is_meant;
  for (Index facet = 0; facet < surface.num_cells(); ++facet)
    is_meant.push_back(std::ranges::all_of(
        surface.cell(facet), [&](Index v) { return is_selected[static_cast<std::size_t>(v)]; }));
  if (!where.means_facets()) return is_meant;
  CellBlock facets = surface;
  for (Index& node : facets.nodes) node += body.first_node;
  const FacetFaces faces(dim, std::move(facets), rest_positions);
  std::vector<bool> is_of_face(is_meant.size(), true);
  if (where.kind == Where::Kind::face)
    is_of_face = facets_of_face(where, faces, body, largest_extent(body, rest_positions, dim), place);
  const double least_cosine = std::cos(where.angle * std::numbers::pi / 180);
  for (Index facet = 0; facet < faces.count(); ++facet) {
    const auto f = static_cast<std::size_t>(facet);
    const bool has_normal =
        !where.normal || faces.normal(facet).dot(where.normal->normalized()) >= least_cosine;
    is_meant[f] = is_meant[f] && is_of_face[f] && has_normal;
  }
  return is_meant;
}

CellBlock select_facets(const Where& where, const std::vector<Index>& selected_vertices, const Body& body,
                        const VectorX& rest_positions, int dim, const std::string& place) {
  if (!where.means_facets()) {
    CellBlock facets = facets_between(selected_vertices, body);
    if (facets.nodes.empty())
      throw InputError(place, "a part of the surface (facets with all their vertices selected)",
                       std::to_string(selected_vertices.size()) + " vertices that bound no facet");
    return facets;
  }
  const CellBlock surface = boundary(local_cells(body)).facets;
  const std::vector<bool> is_meant = meant_facets(where, selected_vertices, body, rest_positions, dim, place);
  CellBlock chosen{.kind = surface.kind, .nodes = {}};
  for (Index facet = 0; facet < surface.num_cells(); ++facet)
    if (is_meant[static_cast<std::size_t>(facet)])
      for (const Index v : surface.cell(facet)) chosen.nodes.push_back(body.first_node + v);
  return chosen;
}

CellBlock facets_between(const std::vector<Index>& selected_vertices, const Body& body) {
  CellBlock surface = boundary(local_cells(body)).facets;
  surface.nodes = whole_cells(surface, selected_vertices, body);
  return surface;
}

std::vector<Index> select_cells(const std::vector<Index>& selected_vertices, const Body& body) {
  return whole_cells(local_cells(body), selected_vertices, body);
}

}  // namespace resilin
