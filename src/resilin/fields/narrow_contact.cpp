#include "resilin/fields/narrow_contact.hpp"

#include <cstddef>

#include "resilin/contact/carried_points.hpp"
#include "resilin/contact/collider_barrier.hpp"
#include "resilin/contact/surface_contact.hpp"

namespace resilin {
namespace {

/// Least share of a node in a point that stands for the node; the middle of a quadrilateral has four.
constexpr double least_share = 0.75;
/// Part of the contact forces that nodes take which are themselves in contact.
constexpr double least_part_at_nodes = 0.5;
/// Contact forces by those of the strain, in sums over the nodes: half where contact alone strains a body.
constexpr double least_part_of_strain = 0.1;

/// Nodes nearer to something than the activation distance, and not only as corners of a facet.
std::vector<char> nodes_in_contact(const World& world, const State& state) {
  std::vector<char> is_met(static_cast<std::size_t>(world.num_nodes()), 0);
  const auto meet = [&](const CarriedPoints& points, Index point) {
    points.for_each_node(point, [&](Index node, double share) {
      if (share >= least_share) is_met[static_cast<std::size_t>(node)] = 1;
    });
  };
  const Conditions conditions = conditions_of(state);
  const auto meet_points_of = [&](const SurfaceContact& contact) {
    for (const PartForce& part : contact.part_forces(state.positions, conditions)) {
      if (part.kind == PairKind::edge_edge) continue;
      meet(contact.surface().vertices, part.vertices[0]);
      if (part.kind == PairKind::point_point) meet(contact.surface().vertices, part.vertices[1]);
    }
  };
  if (world.contact) meet_points_of(*world.contact);
  for (const auto& collider : world.mesh_colliders) meet_points_of(*collider);
  for (const auto& collider : world.colliders) {
    const CarriedPoints& points = collider->points().places;
    for (Index point = 0; point < points.num_points(); ++point)
      if (collider->distance(points.at(world.dimension, point, state.positions), conditions) <
          collider->activation_distance())
        meet(points, point);
  }
  return is_met;
}

}  // namespace

std::vector<bool> have_narrow_contact(const World& world, const State& state) {
  std::vector<bool> is_narrow(world.bodies.size(), false);
  const VectorX& x = state.positions;
  const Conditions conditions = conditions_of(state);
  VectorX contact = VectorX::Zero(x.size()), elastic = contact;
  for (const auto& term : world.terms)
    if (term->properties().category == EnergyCategory::contact) term->add_gradient(x, conditions, contact);
  if (contact.isZero(0)) return is_narrow;
  const std::vector<char> is_met = nodes_in_contact(world, state);
  for (std::size_t b = 0; b < world.bodies.size(); ++b) {
    const Body& body = world.bodies[b];
    if (body.rigid || body.meets_with_skin()) continue;  // points of a skin lie between the nodes
    for (const Domain& domain : body.domains) domain.energy->add_gradient(x, conditions, elastic);
    double all = 0, at_nodes = 0, of_strain = 0;
    int num_met = 0;
    for (Index node = body.first_node; node < body.first_node + body.num_nodes; ++node) {
      const double force = contact.segment(Eigen::Index{node} * world.dimension, world.dimension).norm();
      all += force;
      if (is_met[static_cast<std::size_t>(node)] != 0) {
        at_nodes += force;
        ++num_met;
      }
      of_strain += elastic.segment(Eigen::Index{node} * world.dimension, world.dimension).norm();
    }
    const bool is_between = at_nodes < least_part_at_nodes * all || num_met < 2;
    is_narrow[b] = is_between && all > least_part_of_strain * of_strain;
  }
  return is_narrow;
}

std::vector<std::string> narrow_contact_texts(const World& world, const State& state) {
  std::vector<std::string> texts;
  const std::vector<bool> is_narrow = have_narrow_contact(world, state);
  for (std::size_t b = 0; b < world.bodies.size(); ++b)
    if (is_narrow[b])
      texts.push_back("\"" + world.bodies[b].name +
                      "\" is pressed between its nodes or at one of them, by contact narrower than its "
                      "facets: the estimated "
                      "discretisation error does not include the indentation, and forces may be several "
                      "times too large; compare with finer cells there");
  return texts;
}

}  // namespace resilin
