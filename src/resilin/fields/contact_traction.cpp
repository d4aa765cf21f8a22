#include "resilin/fields/contact_traction.hpp"

#include <algorithm>
#include <map>
#include <vector>

#include "resilin/contact/contact_node.hpp"
#include "resilin/contact/facing_area.hpp"
#include "resilin/mesh/facet.hpp"
#include "resilin/mesh/topology.hpp"
#include "resilin/world/friction.hpp"

namespace resilin {
namespace {

/// The faces around each node that is touched: normals out of the deformed body, areas at rest.
class TouchedFaces {
 public:
  TouchedFaces(const World& world, const VectorX& x, const VectorX& forces) {
    const int dim = world.dimension;
    for (const Body& body : world.bodies) {
      const CellBlock facets = boundary({.kind = body.cell_kind, .nodes = body.cells}).facets;
      for (Index facet = 0; facet < facets.num_cells(); ++facet) {
        const std::span<const Index> nodes = facets.cell(facet);
        const bool is_touched = std::ranges::any_of(
            nodes, [&](Index node) { return !node_position(dim, node, forces).isZero(0); });
        if (!is_touched) continue;
        const CellBlock one{.kind = facets.kind, .nodes = {nodes.begin(), nodes.end()}};
        const Vector3 normal = area_vector(dim, facets.kind, nodes, x).normalized();
        for (const ContactNode& share : contact_nodes(dim, one, world.rest_positions, 1))
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
      visit(node, normal, area);
    }
  }

 private:
  std::map<Index, std::vector<FacetShare>> faces_;
};

VectorX contact_forces(const World& world, const State& state) {
  VectorX gradient = VectorX::Zero(state.positions.size());
  for (const auto& term : world.terms)
    if (term->properties().category == EnergyCategory::contact)
      term->add_gradient(state.positions, conditions_of(state), gradient);
  return -gradient;
}

}  // namespace

VectorX contact_traction(const World& world, const State& state) {
  const int dim = world.dimension;
  const VectorX forces = contact_forces(world, state);
  VectorX along = VectorX::Zero(forces.size());  // minus friction
  if (const auto friction = friction_of(world, state))
    friction->add_gradient(state.positions, conditions_of(state), along);
  VectorX traction = VectorX::Zero(forces.size());
  TouchedFaces(world, state.positions, forces)
      .for_each_pressed(dim, forces, [&](Index node, const Vector3&, double area) {
        traction.segment(Eigen::Index{node} * dim, dim) =
            (forces - along).segment(Eigen::Index{node} * dim, dim) / area;
      });
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
  return pressure;
}

}  // namespace resilin
