#include "resilin/world/selection.hpp"

#include <algorithm>
#include <functional>

#include "resilin/core/error.hpp"
#include "resilin/core/text.hpp"
#include "resilin/mesh/facet.hpp"
#include "resilin/mesh/second_order.hpp"
#include "resilin/mesh/topology.hpp"
#include "resilin/world/description_check.hpp"

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
      return;
    case Where::Kind::all:
    case Where::Kind::group:
    case Where::Kind::box:
    case Where::Kind::sphere:
    case Where::Kind::vertices:
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

/// Nodes, in the world's numbering, of the cells of a block whose nodes are all selected.
std::vector<Index> whole_cells(const CellBlock& block, const std::vector<Index>& selected_vertices,
                               const Body& body) {
  std::vector<bool> is_selected(static_cast<std::size_t>(body.num_nodes), false);
  for (const Index v : selected_vertices) is_selected[static_cast<std::size_t>(v)] = true;
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
  if (selected.empty()) {
    throw InputError(place, "a selection with at least one vertex", "none",
                     describe_extent(body, rest_positions, dim));
  }
  return selected;
}

CellBlock select_facets(const std::vector<Index>& selected_vertices, const Body& body,
                        const std::string& place) {
  CellBlock surface = boundary(local_cells(body)).facets;
  surface.nodes = whole_cells(surface, selected_vertices, body);
  if (surface.nodes.empty()) {
    throw InputError(place, "a part of the surface (facets with all their vertices selected)",
                     std::to_string(selected_vertices.size()) + " vertices that bound no facet");
  }
  return surface;
}

std::vector<Index> select_cells(const std::vector<Index>& selected_vertices, const Body& body) {
  return whole_cells(local_cells(body), selected_vertices, body);
}

}  // namespace resilin
