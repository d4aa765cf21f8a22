#include <algorithm>
#include <map>

#include "resilin/contact/cross_matrix.hpp"
#include "resilin/contact/friction_slopes.hpp"
#include "resilin/contact/pressing_forces.hpp"
#include "resilin/contact/surface_contact.hpp"
#include "resilin/mesh/facet.hpp"

namespace resilin {

void SurfaceContact::add_friction_slopes(const VectorX& x, const VectorX& start, const Conditions& c,
                                         std::vector<FrictionContactSlopes>& slopes) const {
  FrictionContacts contacts;
  add_friction_contacts(x, start, c, contacts);
  if (contacts.size() == 0) return;
  const CollisionSurface& parts = surface_->parts;
  const VectorX places = surface_->places(x, c), start_places = surface_->places(start, c);
  const std::optional<ContactObstacle>& obstacle = surface_->obstacle;
  const double time = c.time - c.delay;
  const std::vector<ContactTerm> terms = terms_at(x, c);
  const TermSet set{*surface_, terms};
  const std::vector<PartForce> forces = resilin::part_forces(set, places);
  const std::vector<PartForceSlopes> of_forces = part_force_slopes(set, places);
  std::size_t next = 0;
  for (const PressingForce& pressing : pressing_slopes(forces)) {
    PartForce pair = forces[pressing.part];
    pair.force = pressing.force;
    const PartForceSlopes& of_pair = of_forces[pressing.part];
    const auto split = static_cast<std::size_t>(num_first(pair.kind)),
               count = static_cast<std::size_t>(num_vertices(pair.kind));
    const auto body_of = [&](Index v) { return parts.bodies[static_cast<std::size_t>(v)]; };
    const Index first = std::min(body_of(pair.vertices[0]), body_of(pair.vertices[split])),
                second = std::max(body_of(pair.vertices[0]), body_of(pair.vertices[split]));
    const Eigen::Index number = Eigen::Index{first} * meetings().num_bodies() + second;
    const double mu = friction_[static_cast<std::size_t>(number)];
    if (!(mu * pair.force > 0)) continue;
    FrictionContactSlopes of{.contact = contacts[next++].contact,
                             .coefficient = number,
                             .mu = mu,
                             .vertices = {},
                             .places = {},
                             .stiffness = {}};
    // Places of the vertices that it has to do with, each once.
    std::map<std::pair<Index, bool>, std::size_t> numbers;
    const auto place_of = [&](Index vertex, bool is_at_start) -> FrictionContactSlopes::Place& {
      const auto [found, is_new] = numbers.try_emplace({vertex, is_at_start}, of.places.size());
      if (is_new)
        of.places.push_back({.nodes = surface_->vertices.weighted_nodes(vertex), .is_at_start = is_at_start});
      return of.places[found->second];
    };
    std::array<Vector3, most_pair_vertices> velocities{};
    for (std::size_t i = 0; i < count; ++i) {
      const Index vertex = pair.vertices[i];
      of.vertices.push_back({pair.weights[i], surface_->vertices.weighted_nodes(vertex)});
      velocities[i].setZero();
      if (!obstacle || !surface_->is_obstacle(vertex)) continue;
      velocities[i] = obstacle->motion.velocity_at(node_position(parts.dim, vertex, places), time);
      of.share_of_rate -= pair.weights[i];
    }
    const SlidingNormals::Slopes of_normal = sliding_normals_->slopes_at(pair, start_places);
    for (std::size_t k = 0; k < count; ++k) {
      FrictionContactSlopes::Place& place = place_of(pair.vertices[k], false);
      place.normal += of_normal.normal * of_pair.normal[k];
      for (std::size_t i = 0; i < count; ++i) {
        const Vector3& of_weight = of_pair.weights[i][k];
        place.normal += of_normal.weights[i] * of_weight.transpose();
        place.velocity -= velocities[i] * of_weight.transpose();
        place.weights.push_back(of_weight);
      }
      if (obstacle && surface_->is_obstacle(pair.vertices[k]))
        place.velocity -= pair.weights[k] * cross_matrix(obstacle->motion.spin(time));
    }
    for (const auto& [vertex, slope] : of_normal.places) place_of(vertex, true).normal += slope;
    for (const auto& [part, slope] : pressing.slopes) {
      const PartForceSlopes& other = of_forces[part];
      for (std::size_t k = 0; k < static_cast<std::size_t>(num_vertices(forces[part].kind)); ++k)
        place_of(forces[part].vertices[k], false).limit += mu * slope * other.force[k];
      const SofterBodies softer = softer_bodies(*surface_, terms[other.term]);
      for (std::size_t side = 0; side < 2; ++side)
        of.stiffness.emplace_back(softer.bodies[side], mu * slope * forces[part].force * softer.shares[side]);
    }
    slopes.push_back(std::move(of));
  }
}

}  // namespace resilin
