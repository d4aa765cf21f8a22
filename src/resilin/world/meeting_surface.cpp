#include "resilin/world/meeting_surface.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>

#include "resilin/core/error.hpp"
#include "resilin/material/rest_tangents.hpp"
#include "resilin/mesh/facet.hpp"
#include "resilin/mesh/second_moments.hpp"
#include "resilin/mesh/topology.hpp"
#include "resilin/world/axisymmetry.hpp"
#include "resilin/world/rigid_shape.hpp"

namespace resilin {

double youngs_modulus(const Domain& domain) {
  std::vector<double> constants;
  for (const auto& [name, value] : domain.constants) constants.push_back(value);
  return youngs_modulus(domain.law_info(), constants);
}

std::size_t softest_domain(const Body& body) {
  std::size_t softest = 0;
  for (std::size_t d = 1; d < body.domains.size(); ++d) {
    const Domain& domain = body.domains[d];
    if (domain.is_rigid) continue;
    if (body.domains[softest].is_rigid || youngs_modulus(domain) < youngs_modulus(body.domains[softest]))
      softest = d;
  }
  return softest;
}

double youngs_modulus(const Body& body) {
  return body.rigid ? body.rigid->contact_modulus : youngs_modulus(body.domains[softest_domain(body)]);
}

double youngs_modulus(const LawInfo& law, const std::vector<double>& constants) {
  double E = 0;
  for_each_rest_tangent(law, constants, [&E](std::size_t, const double* A) {
    E = Hooke{A[9 + 1], A[4]}.youngs_modulus();  // dP_01/dF_01, dP_00/dF_11
  });
  return E;
}

namespace {

constexpr double stiffness_share = 0.1;    ///< kappa / E: notes on "Convergent IPC", the authors' toolkit
constexpr double activation_share = 5e-3;  ///< activation distance, relative to the smallest body's extent
/// Share of the square of a facet's longest side: a smaller area is none.
constexpr double flat_share = 1e-12;
constexpr double thickness_share = 0.1;  ///< activation distance, relative to the thinnest body's thickness

double barrier_stiffness(const Body& body, std::optional<double> asked) {
  return asked ? *asked : stiffness_share * youngs_modulus(body);
}

/// Triangles, in 2D lines: those of a skin, by its vertices.
CellBlock skin_facets(const Skin& skin, int dim) {
  const bool fills_the_plane = dim == 2 && skin.facets.kind == CellKind::triangle;
  return fills_the_plane ? boundary(skin.facets).facets : skin.facets;
}

ColliderMesh mesh_of(const Skin& skin, int dim) {
  ColliderMesh mesh{.vertices = {}, .facets = skin_facets(skin, dim).nodes};
  for (Index vertex = 0; vertex < skin.num_vertices(); ++vertex)
    mesh.vertices.push_back(node_position(3, vertex, skin.rest_positions));
  return mesh;
}

Vector3 lengths_of_cells(const World& world, const Body& body) {
  return second_moments(body.cell_kind, body.cells, world.contact_shape(), world.dimension).lengths();
}

/// At rest, of what the surface holds that a body meets others with, or of that surface: rising [m].
Vector3 contact_lengths(const World& world, const Body& body) {
  if (body.rigid && body.rigid->is_region())  // has no surface of its own
    return Vector3::Constant(std::numeric_limits<double>::infinity());
  if (!body.meets_with_skin()) return lengths_of_cells(world, body);
  const ColliderMesh mesh = mesh_of(*body.skin, world.dimension);
  const bool has_inside = is_closed(mesh, world.dimension);
  const Vector3 lengths = second_moments(mesh.vertices, mesh.facets, world.dimension, has_inside).lengths();
  if (!has_inside || lengths[3 - world.dimension] > 0) return lengths;
  // Its facets are not all seen from outside anticlockwise.
  return second_moments(mesh.vertices, mesh.facets, world.dimension, false).lengths();
}

double mean_side(const ColliderMesh& mesh, std::size_t num_corners) {
  double sum = 0;
  for (std::size_t k = 0; k < mesh.facets.size(); ++k) {
    const std::size_t first = k - k % num_corners, next = first + (k + 1) % num_corners;
    sum += (mesh.vertices[static_cast<std::size_t>(mesh.facets[next])] -
            mesh.vertices[static_cast<std::size_t>(mesh.facets[k])])
               .norm();
  }
  return sum / static_cast<double>(mesh.facets.size());
}

}  // namespace

double smallest_extent(const World& world) {
  double smallest = std::numeric_limits<double>::infinity();
  for (const Body& body : world.bodies) smallest = std::min(smallest, contact_lengths(world, body)[2]);
  return smallest;
}

CarriedPoints skin_vertices(const Body& body) {
  CarriedPoints vertices;
  for (Index vertex = 0; vertex < body.skin->num_vertices(); ++vertex) {
    body.skin->embedding.append_weights(vertex, vertices.nodes, vertices.shares);
    vertices.end_row();
  }
  return vertices;
}

ContactBody meeting_body(const Body& body, int dim, std::optional<double> stiffness) {
  const double kappa = barrier_stiffness(body, stiffness);
  if (body.rigid && body.rigid->is_region())
    return {{.kind = dim == 3 ? CellKind::triangle : CellKind::line, .nodes = {}}, kappa};
  if (!body.meets_with_skin()) return {boundary({.kind = body.cell_kind, .nodes = body.cells}).facets, kappa};
  return {skin_facets(*body.skin, dim), kappa, {body.skin, &body.skin->embedding}};
}

std::vector<ContactBody> contact_bodies(const World& world, std::optional<double> stiffness) {
  std::vector<ContactBody> bodies;
  for (const Body& body : world.bodies) bodies.push_back(meeting_body(body, world.dimension, stiffness));
  return bodies;
}

std::string point_name(const Body& body, Index number) {
  const std::string of = " of \"" + body.name + '"';
  if (!body.meets_with_skin()) return "vertex " + std::to_string(number - body.first_node) + of;
  return "vertex " + std::to_string(number + 1) + " of " + body.skin->name + ", the skin" + of + ",";
}

bool has_inside(const World& world, const Body& body) {
  return !body.meets_with_skin() || is_closed(mesh_of(*body.skin, world.dimension), world.dimension);
}

std::vector<std::uint8_t> held_nodes(const World& world) {
  const int dim = world.dimension;
  std::vector<Support> always;  // those that let go leave their vertices to contact
  std::ranges::copy_if(world.supports, std::back_inserter(always), &std::vector<double>::empty,
                       &Support::switches);
  const std::vector<std::int32_t> support_of = supports_of_unknowns(dim, world.num_nodes(), always);
  std::vector<std::uint8_t> is_held;
  for (auto first = support_of.begin(); first != support_of.end(); first += dim)
    is_held.push_back(std::all_of(first, first + dim, [](std::int32_t support) { return support >= 0; }));
  return is_held;
}

ContactPoints contact_points(const World& world, std::optional<double> stiffness) {
  const int dim = world.dimension;
  const std::vector<std::uint8_t> is_held = held_nodes(world);
  const Depth depth = depth_of(world);
  ContactPoints all;
  for (const Body& body : world.bodies) {
    const ContactBody own = meeting_body(body, dim, stiffness);
    if (own.carrier == nullptr) {
      for (const ContactNode& node :
           contact_nodes(dim, own.facets, world.contact_shape(), own.stiffness, depth))
        if (is_held[static_cast<std::size_t>(node.node)] == 0) all.add(node);
      continue;
    }
    ContactSurface surface = make_contact_surface(dim, {&own, 1}, world.contact_shape(), {}, depth);
    leave_held_out(surface, is_held);
    for (const Index vertex : surface.parts.points) {
      const auto v = static_cast<std::size_t>(vertex);
      surface.vertices.for_each_node(vertex, [&](Index node, double share) {
        all.places.nodes.push_back(node);
        all.places.shares.push_back(share);
      });
      all.places.end_row();
      all.stiffness.push_back(own.stiffness * surface.point_areas[v]);
      all.numbers.push_back(surface.numbers[v]);
    }
  }
  return all;
}

double thinnest_extent(const World& world, const Body& body) {
  const bool is_sheet = !has_inside(world, body);  // its cells are as thick as they are
  return (is_sheet ? lengths_of_cells(world, body) : contact_lengths(world, body))[3 - world.dimension];
}

double default_activation_distance(const World& world) {
  double distance = activation_share * smallest_extent(world);
  for (const Body& body : world.bodies)
    distance = std::min(distance, thickness_share * thinnest_extent(world, body));
  const auto dim = static_cast<std::size_t>(world.dimension);
  for (const Body& body : world.bodies)
    if (body.meets_with_skin())
      distance = std::min(distance, mean_side(mesh_of(*body.skin, world.dimension), dim));
  return distance;
}

void require_areas(const ColliderMesh& mesh, const World& world, const std::string& place) {
  for (std::size_t f = 0; f + 3 <= mesh.facets.size(); f += 3) {
    if (mesh.facets[f] == mesh.facets[f + 1] || mesh.facets[f + 1] == mesh.facets[f + 2]) continue;
    const auto corner = [&](std::size_t k) {
      return mesh.vertices[static_cast<std::size_t>(mesh.facets[f + k])];
    };
    const Vector3 a = corner(0), ab = corner(1) - a, ac = corner(2) - a;
    const double longest = std::max({ab.squaredNorm(), ac.squaredNorm(), (ac - ab).squaredNorm()});
    if (ab.cross(ac).norm() > flat_share * longest) continue;
    throw InputError(place, "triangles with an area",
                     "one without at " + world.place_text(world.origin + a) + ", " +
                         world.place_text(world.origin + corner(1)) + ", " +
                         world.place_text(world.origin + corner(2)),
                     "leave it out, or join its vertices");
  }
}

void check_contact_skin(const Body& body, const World& world, const std::string& place) {
  if (body.meets_with_skin() && world.dimension == 3)
    require_areas(mesh_of(*body.skin, world.dimension), world, place + ".skin: " + body.skin->name);
}

}  // namespace resilin
