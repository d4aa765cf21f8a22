#include "resilin/sensitivity/barrier_links.hpp"

#include <algorithm>

#include "resilin/core/text.hpp"
#include "resilin/sensitivity/constant_slopes.hpp"
#include "resilin/world/meeting_surface.hpp"

namespace resilin {
namespace {

BarrierLinks::Barrier of_surface(std::size_t term, const ContactSurface& surface) {
  BarrierLinks::Barrier barrier{term, {}, VectorX::Zero(static_cast<Eigen::Index>(surface.stiffness.size()))};
  const std::size_t num_bodies = surface.stiffness.size() - (surface.obstacle ? 1 : 0);
  for (std::size_t body = 0; body < num_bodies; ++body) {
    barrier.bodies.push_back(static_cast<Index>(body));
    barrier.stiffness[static_cast<Eigen::Index>(body)] = surface.stiffness[body];
  }
  if (surface.obstacle) barrier.bodies.push_back(-1);
  return barrier;
}

BarrierLinks::Barrier of_collider(std::size_t term, const ColliderBarrier& collider, const World& world) {
  const ContactPoints& points = collider.points();
  BarrierLinks::Barrier barrier{term, {}, VectorX::Zero(collider.num_stiffnesses())};
  barrier.stiffness.head(points.size()) =
      Eigen::Map<const VectorX>(points.stiffness.data(), Eigen::Index{points.size()});
  for (Index point = 0; point < points.size(); ++point) {
    const Body& body = world.body_of(points.places.nodes_of(point)[0]);
    barrier.bodies.push_back(static_cast<Index>(&body - world.bodies.data()));
  }
  if (collider.facets() != nullptr) {
    const BarrierLinks::Barrier of_facets = of_surface(term, collider.facets()->surface());
    barrier.bodies.insert(barrier.bodies.end(), of_facets.bodies.begin(), of_facets.bodies.end());
    barrier.stiffness.tail(of_facets.stiffness.size()) = of_facets.stiffness;
  }
  return barrier;
}

/// As in world/rigid_shape.cpp. Without a deformable body it is the rigid body itself, which has no
/// constants.
BarrierLinks::FollowedDomain followed_by(const World& world, std::size_t body) {
  BarrierLinks::FollowedDomain followed{body, softest_domain(world.bodies[body])};
  if (!world.bodies[body].rigid) return followed;
  double greatest = 0;
  for (std::size_t b = 0; b < world.bodies.size(); ++b) {
    if (world.bodies[b].rigid) continue;
    for (std::size_t d = 0; d < world.bodies[b].domains.size(); ++d) {
      const Domain& domain = world.bodies[b].domains[d];
      if (domain.is_rigid || !(youngs_modulus(domain) > greatest)) continue;
      greatest = youngs_modulus(domain);
      followed = {b, d};
    }
  }
  return followed;
}

}  // namespace

// Colliders stand among the terms in the order of the scene, those of facets among the others.
BarrierLinks::BarrierLinks(const World& world) : world_(world) {
  const Description& description = *world.made_from;
  std::size_t collider = 0, exact = 0, of_facets = 0;
  for (std::size_t t = 0; t < world.terms.size(); ++t) {
    const std::shared_ptr<const Energy>& term = world.terms[t];
    if (exact < world.colliders.size() && term == world.colliders[exact]) {
      const ColliderBarrier& of = *world.colliders[exact++];
      if (!description.colliders[collider++].stiffness) barriers_.push_back(of_collider(t, of, world));
    } else if (of_facets < world.mesh_colliders.size() && term == world.mesh_colliders[of_facets]) {
      const ContactSurface& of = world.mesh_colliders[of_facets++]->surface();
      if (!description.colliders[collider++].stiffness) barriers_.push_back(of_surface(t, of));
    } else if (world.contact && term == world.contact && !description.contact.stiffness) {
      barriers_.push_back(of_surface(t, world.contact->surface()));
    }
  }
  if (barriers_.empty()) return;
  for (std::size_t b = 0; b < world.bodies.size(); ++b) {
    followed_.push_back(followed_by(world, b));
    const auto [body, domain] = followed_.back();
    modulus_slopes_.push_back(log_modulus_slopes(world.bodies[body].domains[domain]));
  }
}

bool BarrierLinks::moves(const Barrier& barrier, const WorldChange& change) const {
  return std::ranges::any_of(barrier.bodies, [&](Index body) {
    if (body < 0) return false;
    const FollowedDomain& followed = followed_[static_cast<std::size_t>(body)];
    return change.bodies[followed.body].domains[followed.domain].constants.size() > 0;
  });
}

// d(kappa) = kappa d(log E)
void BarrierLinks::spread(const Barrier& barrier, const WorldChange& change, VectorX& stiffness) const {
  VectorX by_body = VectorX::Zero(static_cast<Eigen::Index>(world_.bodies.size()));
  for (std::size_t b = 0; b < world_.bodies.size(); ++b) {
    const VectorX& constants = change.bodies[followed_[b].body].domains[followed_[b].domain].constants;
    const Eigen::Index n = modulus_slopes_[b].size(), num_sets = constants.size() / n;
    for (Eigen::Index set = 0; set < num_sets; ++set)
      by_body[static_cast<Eigen::Index>(b)] +=
          modulus_slopes_[b].dot(constants.segment(set * n, n)) / static_cast<double>(num_sets);
  }
  for (std::size_t i = 0; i < barrier.bodies.size(); ++i)
    if (const auto k = static_cast<Eigen::Index>(i); barrier.bodies[i] >= 0)
      stiffness[k] += barrier.stiffness[k] * by_body[barrier.bodies[i]];
}

void BarrierLinks::gather(const Barrier& barrier, const VectorX& stiffness, WorldChange& slopes) const {
  VectorX by_body = VectorX::Zero(static_cast<Eigen::Index>(world_.bodies.size()));
  for (std::size_t i = 0; i < barrier.bodies.size(); ++i)
    if (const auto k = static_cast<Eigen::Index>(i); barrier.bodies[i] >= 0)
      by_body[barrier.bodies[i]] += barrier.stiffness[k] * stiffness[k];
  for (std::size_t b = 0; b < world_.bodies.size(); ++b) {
    VectorX& constants = slopes.bodies[followed_[b].body].domains[followed_[b].domain].constants;
    const Eigen::Index n = modulus_slopes_[b].size(), num_sets = constants.size() / n;
    for (Eigen::Index set = 0; set < num_sets; ++set)
      constants.segment(set * n, n) +=
          by_body[static_cast<Eigen::Index>(b)] / static_cast<double>(num_sets) * modulus_slopes_[b];
  }
}

std::string kink_of_barrier(const World& world, const WorldChange& change) {
  if (!world.contact || world.made_from->contact.stiffness) return {};
  const std::vector<double>& stiffness = world.contact->surface().stiffness;
  for (std::size_t a = 0; a < world.bodies.size(); ++a)
    for (std::size_t b = a + 1; b < world.bodies.size(); ++b) {
      const auto follows = [&](std::size_t body) {
        const std::size_t softest = softest_domain(world.bodies[body]);
        return change.bodies[body].domains[softest].constants.size() > 0;
      };
      const bool is_asked = follows(a) || follows(b);
      if (world.bodies[a].rigid || world.bodies[b].rigid) continue;  // they follow the same domain, or none
      if (!is_asked || stiffness[a] != stiffness[b] || !world.meet(a, b)) continue;
      return "derivatives by materials: \"" + world.bodies[a].name + "\" and \"" + world.bodies[b].name +
             "\" are equally stiff, and the contact barrier follows the softer body: in contact these are "
             "means of the one-sided derivatives; contact.stiffness = " +
             format_number(stiffness[a]) + " keeps it constant";
    }
  return {};
}

}  // namespace resilin
