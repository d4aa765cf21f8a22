#include "resilin/fields/contact_traction.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <span>
#include <vector>

#include "resilin/contact/contact_node.hpp"
#include "resilin/contact/facing_area.hpp"
#include "resilin/mesh/cell_kind.hpp"
#include "resilin/mesh/facet.hpp"
#include "resilin/mesh/topology.hpp"
#include "resilin/world/axisymmetry.hpp"
#include "resilin/world/friction.hpp"
#include "resilin/world/meeting_surface.hpp"

namespace resilin {
namespace {

/// Nodes in the middle of edges, where a skin is carried by quadratic cells: their forces go to the ends of
/// the edges, half each, as those of the linear shape functions, which are never negative in a cell.
class MiddleNodes {
 public:
  explicit MiddleNodes(const Body& body) {
    const ElementInfo& element = body.domains.element();
    if (element.degree < 2) return;
    const auto width = static_cast<std::size_t>(element.num_nodes);
    for (std::size_t first = 0; first < body.cells.size(); first += width) {
      auto middle = first + static_cast<std::size_t>(element.num_corners());
      for (const auto& [i, j] : cell_edges(body.cell_kind))
        ends_[body.cells[middle++]] = {body.cells[first + static_cast<std::size_t>(i)],
                                       body.cells[first + static_cast<std::size_t>(j)]};
    }
  }

  /// Calls `visit(corner, share)`: a corner is its own.
  template <class Visit>
  void for_each_corner(Index node, const Visit& visit) const {
    const auto found = ends_.find(node);
    if (found == ends_.end()) return visit(node, 1.0);
    for (const Index end : found->second) visit(end, 0.5);
  }
  /// Gathers values of nodes, dim each.
  void gather(VectorX& values, int dim) const {
    for (const auto& [middle, ends] : ends_)
      for (int k = 0; k < dim; ++k) {
        double& value = values[Eigen::Index{middle} * dim + k];
        for (const Index end : ends) values[Eigen::Index{end} * dim + k] += 0.5 * value;
        value = 0;
      }
  }
  void fill(VectorX& values, int dim) const {
    for (const auto& [middle, ends] : ends_)
      for (int k = 0; k < dim; ++k)
        values[Eigen::Index{middle} * dim + k] =
            0.5 * (values[Eigen::Index{ends[0]} * dim + k] + values[Eigen::Index{ends[1]} * dim + k]);
  }

 private:
  std::map<Index, std::array<Index, 2>> ends_;
};

/// Calls `visit(middles)` for each body that meets others with its skin.
template <class Visit>
void for_each_skin(const World& world, const Visit& visit) {
  for (const Body& body : world.bodies)
    if (body.meets_with_skin()) visit(MiddleNodes(body));
}

/// The faces around each node that is touched: normals out of the deformed body, areas at rest.
class TouchedFaces {
 public:
  TouchedFaces(const World& world, const VectorX& x, const VectorX& forces) {
    const int dim = world.dimension;
    for (const Body& body : world.bodies) {
      const auto own =
          forces.segment(Eigen::Index{body.first_node} * dim, Eigen::Index{body.num_nodes} * dim);
      if (own.isZero(0)) continue;
      if (body.meets_with_skin()) {
        add_skin(world, body, x);
        continue;
      }
      const CellBlock facets = boundary({.kind = body.cell_kind, .nodes = body.cells}).facets;
      for (Index facet = 0; facet < facets.num_cells(); ++facet) {
        const std::span<const Index> nodes = facets.cell(facet);
        const bool is_touched = std::ranges::any_of(
            nodes, [&](Index node) { return !node_position(dim, node, forces).isZero(0); });
        if (!is_touched) continue;
        const CellBlock one{.kind = facets.kind, .nodes = {nodes.begin(), nodes.end()}};
        const Vector3 normal = area_vector(dim, facets.kind, nodes, x).normalized();
        for (const ContactNode& share : contact_nodes(dim, one, world.rest_positions, 1, depth_of(world)))
          faces_[share.node].push_back({normal, share.stiffness});
      }
    }
  }

  /// Calls `visit(node, normal, area)` of what a force presses on.
  template <class Visit>
  void for_each_pressed(int dim, const VectorX& forces, const Visit& visit) const {
    for (const auto& [node, faces] : faces_) {
      const Vector3 force = node_position(dim, node, forces);
      if (force.isZero(0)) continue;
      Vector3 normal = Vector3::Zero();
      for (const FacetShare& face : faces)
        normal += face.area * std::max(0.0, -face.normal.dot(force.normalized())) * face.normal;
      if (normal.isZero(0)) continue;
      normal.normalize();
      double area = 0;
      for (const FacetShare& face : faces) area += face.area * std::max(0.0, face.normal.dot(normal));
      if (area > 0) visit(node, normal, area);
    }
  }

 private:
  /// On a skin each node has as much of a facet as it carries of its vertices.
  void add_skin(const World& world, const Body& body, const VectorX& x) {
    const int dim = world.dimension;
    const MiddleNodes middles(body);
    const CellBlock facets = meeting_body(body, dim, 1.0).facets;
    const CarriedPoints vertices = skin_vertices(body);
    const VectorX rest = vertices.places(dim, world.rest_positions), now = vertices.places(dim, x);
    const double side = outward_side(dim, facets, rest);
    for (Index facet = 0; facet < facets.num_cells(); ++facet) {
      const std::span<const Index> corners = facets.cell(facet);
      const double share = world.thickness * area_vector(dim, facets.kind, corners, rest).norm() / dim;
      const Vector3 normal = side * area_vector(dim, facets.kind, corners, now).normalized();
      for (const Index vertex : corners)
        vertices.for_each_node(vertex, [&](Index node, double weight) {
          middles.for_each_corner(node, [&](Index corner, double half) {
            faces_[corner].push_back({normal, half * weight * share});
          });
        });
    }
  }

  /// 1 for facets that are anticlockwise seen from outside, else -1: files have both.
  static double outward_side(int dim, const CellBlock& facets, const VectorX& places) {
    Vector3 center = Vector3::Zero();
    for (const Index vertex : facets.nodes) center += node_position(dim, vertex, places);
    center /= static_cast<double>(facets.nodes.size());
    double volume = 0;
    for (Index facet = 0; facet < facets.num_cells(); ++facet)
      volume += area_vector(dim, facets.kind, facets.cell(facet), places)
                    .dot(node_position(dim, facets.cell(facet)[0], places) - center);
    return volume < 0 ? -1 : 1;
  }

  std::map<Index, std::vector<FacetShare>> faces_;
};

VectorX contact_forces(const World& world, const State& state) {
  VectorX gradient = VectorX::Zero(state.positions.size());
  for (const auto& term : world.terms)
    if (term->properties().category == EnergyCategory::contact)
      term->add_gradient(state.positions, conditions_of(state), gradient);
  for_each_skin(world, [&](const MiddleNodes& middles) { middles.gather(gradient, world.dimension); });
  return -gradient;
}

}  // namespace

VectorX contact_traction(const World& world, const State& state) {
  const int dim = world.dimension;
  const VectorX forces = contact_forces(world, state);
  VectorX along = VectorX::Zero(forces.size());  // minus friction
  if (const auto friction = friction_of(world, state))
    friction->add_gradient(state.positions, conditions_of(state), along);
  for_each_skin(world, [&](const MiddleNodes& middles) { middles.gather(along, dim); });
  VectorX traction = VectorX::Zero(forces.size());
  TouchedFaces(world, state.positions, forces)
      .for_each_pressed(dim, forces, [&](Index node, const Vector3&, double area) {
        traction.segment(Eigen::Index{node} * dim, dim) =
            (forces - along).segment(Eigen::Index{node} * dim, dim) / area;
      });
  for_each_skin(world, [&](const MiddleNodes& middles) { middles.fill(traction, dim); });
  return traction;
}

VectorX contact_pressure(const World& world, const State& state) {
  const int dim = world.dimension;
  const VectorX forces = contact_forces(world, state);
  VectorX pressure = VectorX::Zero(world.num_nodes());
  TouchedFaces(world, state.positions, forces)
      .for_each_pressed(dim, forces, [&](Index node, const Vector3& normal, double area) {
        pressure[node] = -node_position(dim, node, forces).dot(normal) / area;
      });
  for_each_skin(world, [&](const MiddleNodes& middles) { middles.fill(pressure, 1); });
  return pressure;
}

namespace {

/// Forces of contact on the nodes, by what presses.
struct PressingForces {
  ContactPatch patch;
  VectorX forces;
};

std::vector<PressingForces> forces_by_source(const World& world, const State& state) {
  const Conditions conditions = conditions_of(state);
  std::vector<PressingForces> all;
  for (std::size_t t = 0; t < world.origins.size(); ++t) {
    if (world.origins[t].kind != TermOrigin::Kind::collider) continue;
    VectorX gradient = VectorX::Zero(state.positions.size());
    world.terms[t]->add_gradient(state.positions, conditions, gradient);
    if (gradient.isZero(0)) continue;
    PressingForces& pressing = all.emplace_back();
    pressing.patch.collider = world.terms[t]->name();
    pressing.forces = -gradient;
  }
  if (!world.contact) return all;
  const int dim = world.dimension;
  const ContactSurface& surface = world.contact->surface();
  std::map<std::array<Index, 2>, VectorX> of_bodies;
  for (const PartForce& part : world.contact->part_forces(state.positions, conditions)) {
    const auto split = static_cast<std::size_t>(num_first(part.kind));
    const auto body_of = [&](std::size_t i) {
      return surface.parts.bodies[static_cast<std::size_t>(part.vertices[i])];
    };
    const Index first = body_of(0), second = body_of(split);
    const auto [low, high] = std::minmax(first, second);
    if (low == high) continue;
    VectorX& forces = of_bodies.try_emplace({low, high}, VectorX::Zero(state.positions.size())).first->second;
    for (std::size_t i = 0; i < static_cast<std::size_t>(num_vertices(part.kind)); ++i) {
      if (body_of(i) != low) continue;
      surface.vertices.for_each_node(part.vertices[i], [&](Index node, double share) {
        forces.segment(Eigen::Index{node} * dim, dim) +=
            share * part.weights[i] * part.force * part.normal.head(dim);
      });
    }
  }
  for (auto& [bodies, forces] : of_bodies) {
    PressingForces& pressing = all.emplace_back();
    pressing.patch.body = bodies[0];
    pressing.patch.other = bodies[1];
    pressing.forces = std::move(forces);
  }
  return all;
}

/// A node of a patch.
struct PressedNode {
  Index node;
  double area, force;
};

void measure_patch(const World& world, const State& state, const std::vector<PressedNode>& nodes,
                   ContactPatch& patch) {
  constexpr double least_share = 0.01;
  for (const PressedNode& at : nodes)
    patch.largest_pressure = std::max(patch.largest_pressure, at.force / at.area);
  constexpr double infinity = std::numeric_limits<double>::infinity();
  Vector3 low = Vector3::Constant(infinity), high = -low;
  for (const PressedNode& at : nodes) {
    const Vector3 x = world.place_of(at.node, state.positions);
    patch.force += at.force;
    patch.center += at.force * x;
    if (!(at.force / at.area > least_share * patch.largest_pressure)) continue;
    patch.area += at.area;
    low = low.cwiseMin(x);
    high = high.cwiseMax(x);
  }
  patch.center /= patch.force;
  patch.extent = high - low;
}

}  // namespace

std::vector<ContactPatch> contact_patches(const World& world, const State& state) {
  const int dim = world.dimension;
  std::vector<PressingForces> sources = forces_by_source(world, state);
  std::vector<ContactPatch> patches;
  if (sources.empty()) return patches;
  VectorX touched = VectorX::Zero(state.positions.size());
  for (PressingForces& source : sources) {
    for_each_skin(world, [&](const MiddleNodes& middles) { middles.gather(source.forces, dim); });
    touched += source.forces.cwiseAbs();
  }
  const TouchedFaces faces(world, state.positions, touched);
  for (PressingForces& source : sources) {
    std::vector<PressedNode> nodes;
    faces.for_each_pressed(dim, source.forces, [&](Index node, const Vector3& normal, double area) {
      const double force = -node_position(dim, node, source.forces).dot(normal);
      if (force > 0) nodes.push_back({.node = node, .area = area, .force = force});
    });
    if (nodes.empty()) continue;
    measure_patch(world, state, nodes, source.patch);
    patches.push_back(std::move(source.patch));
  }
  return patches;
}

}  // namespace resilin
