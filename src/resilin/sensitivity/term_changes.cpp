#include "resilin/sensitivity/term_changes.hpp"

#include <algorithm>

#include "resilin/energy/dead_load.hpp"
#include "resilin/sensitivity/constant_slopes.hpp"
#include "resilin/world/damping.hpp"

namespace resilin {

bool WorldChange::has_mass() const {
  return rest_positions.size() > 0 || std::ranges::any_of(bodies, &OfBody::has_density);
}

TermLinks::TermLinks(const World& world)
    : world_(world), description_(*world.made_from), barriers_(world), contacts_(world) {
  std::vector<std::size_t> viscous_bodies;
  for (std::size_t b = 0; b < description_.bodies.size(); ++b) {
    const DampingDescription& damping = description_.bodies[b].damping;
    if (damping.stiffness != 0 || damping.shear_viscosity != 0 || damping.bulk_viscosity != 0)
      viscous_bodies.push_back(b);
  }
  for (std::size_t t = world.bodies.size() + description_.loads.size(); t < world.terms.size(); ++t) {
    const EnergyCategory category = world.terms[t]->properties().category;
    if (category == EnergyCategory::external && world.terms[t]->name() == "gravity")
      gravity_ = static_cast<int>(t);
    if (category == EnergyCategory::inertia) inertia_ = static_cast<int>(t);
    if (category != EnergyCategory::damping) continue;
    if (viscous_.size() < viscous_bodies.size())
      viscous_.push_back({t, viscous_bodies[viscous_.size()]});
    else
      mass_damping_ = static_cast<int>(t);
  }
}

CellMasses TermLinks::masses_of(std::size_t body, double density) const {
  const Body& of = world_.bodies[body];
  return {of.elastic->element(), of.cells, world_.rest_positions, density,
          of.mass_kind == MassKind::consistent};
}

bool TermLinks::moves_gravity(const WorldChange& change) const {
  return gravity_ >= 0 && (change.has_gravity || change.has_mass());
}

bool TermLinks::moves_viscosity(const WorldChange& change, std::size_t body) const {
  const WorldChange::OfBody& of = change.bodies[body];
  return of.has_damping || (of.constants.size() > 0 && description_.bodies[body].damping.stiffness != 0);
}

TermChanges TermLinks::zero(const WorldChange& asked) const {
  TermChanges terms(world_.terms.size());
  const Eigen::Index num_unknowns = world_.rest_positions.size();
  const auto add = [&](std::size_t term, const std::string& name, Eigen::Index size) {
    terms[term][name] = VectorX::Zero(size);
  };
  const std::size_t num_bodies = world_.bodies.size();
  for (std::size_t b = 0; b < num_bodies; ++b)
    if (asked.bodies[b].constants.size() > 0) add(b, "constants", asked.bodies[b].constants.size());
  for (std::size_t l = 0; l < asked.loads.size(); ++l)
    for (const auto& [name, numbers] : asked.loads[l]) add(num_bodies + l, name, numbers.size());
  if (asked.rest_positions.size() > 0)
    for (std::size_t t = 0; t < num_bodies + asked.loads.size(); ++t)
      for (const EnergyParameter& parameter : world_.terms[t]->parameters())
        if (parameter.name == "rest_positions") add(t, "rest_positions", num_unknowns);
  if (moves_gravity(asked)) add(static_cast<std::size_t>(gravity_), "forces", num_unknowns);
  if (inertia_ >= 0 && asked.has_mass())
    add(static_cast<std::size_t>(inertia_), "mass", world_.mass->num_entries());
  const bool changes_damping = std::ranges::any_of(asked.bodies, &WorldChange::OfBody::has_damping);
  if (mass_damping_ >= 0 && (asked.has_mass() || changes_damping))
    add(static_cast<std::size_t>(mass_damping_), "mass", world_.mass->num_entries());
  for (const auto& [term, body] : viscous_) {
    const Index num_sets =
        description_.bodies[body].damping.stiffness == 0 ? 1 : world_.bodies[body].num_cells();
    if (moves_viscosity(asked, body)) add(term, "viscosities", Eigen::Index{2} * num_sets);
    if (asked.rest_positions.size() > 0) add(term, "rest_positions", num_unknowns);
  }
  for (const BarrierLinks::Barrier& barrier : barriers_.all())
    if (BarrierLinks::moves(barrier, asked)) add(barrier.term, "barrier_stiffness", barrier.stiffness.size());
  contacts_.add_zero(asked, terms);
  return terms;
}

TermChanges TermLinks::spread(const WorldChange& change) const {
  TermChanges terms = zero(change);
  const std::size_t num_bodies = world_.bodies.size();
  for (std::size_t b = 0; b < num_bodies; ++b)
    if (change.bodies[b].constants.size() > 0) terms[b]["constants"] = change.bodies[b].constants;
  for (std::size_t l = 0; l < change.loads.size(); ++l)
    for (const auto& [name, numbers] : change.loads[l]) terms[num_bodies + l][name] = numbers;
  for (std::map<std::string, VectorX, std::less<>>& of_term : terms)
    if (const auto found = of_term.find("rest_positions"); found != of_term.end())
      found->second = change.rest_positions;
  if (moves_gravity(change)) spread_gravity(change, terms[static_cast<std::size_t>(gravity_)]["forces"]);
  for (const int term : {inertia_, mass_damping_}) {
    if (term < 0) continue;
    const auto found = terms[static_cast<std::size_t>(term)].find("mass");
    if (found == terms[static_cast<std::size_t>(term)].end()) continue;
    for (std::size_t b = 0; b < num_bodies; ++b) {
      const double density = world_.bodies[b].density;
      const double alpha = term == inertia_ ? 1 : description_.bodies[b].damping.mass;
      const double of_alpha = term == inertia_ ? 0 : change.bodies[b].mass_damping;
      masses_of(b, alpha * density)
          .add_change(*world_.mass, alpha * change.bodies[b].density + of_alpha * density,
                      change.rest_positions, found->second);
    }
  }
  for (const auto& [term, body] : viscous_)
    if (moves_viscosity(change, body)) spread_viscosities(change, body, terms[term]["viscosities"]);
  for (const BarrierLinks::Barrier& barrier : barriers_.all())
    if (BarrierLinks::moves(barrier, change))
      barriers_.spread(barrier, change, terms[barrier.term]["barrier_stiffness"]);
  contacts_.spread(change, terms);
  return terms;
}

void TermLinks::gather(const TermChanges& terms, WorldChange& slopes) const {
  const std::size_t num_bodies = world_.bodies.size();
  for (std::size_t b = 0; b < num_bodies; ++b)
    if (slopes.bodies[b].constants.size() > 0)
      slopes.bodies[b].constants += terms[b].find("constants")->second;
  for (std::size_t l = 0; l < slopes.loads.size(); ++l)
    for (auto& [name, numbers] : slopes.loads[l]) numbers += terms[num_bodies + l].find(name)->second;
  for (const std::map<std::string, VectorX, std::less<>>& of_term : terms)
    if (const auto found = of_term.find("rest_positions"); found != of_term.end())
      slopes.rest_positions += found->second;
  if (moves_gravity(slopes))
    gather_gravity(terms[static_cast<std::size_t>(gravity_)].find("forces")->second, slopes);
  for (const int term : {inertia_, mass_damping_}) {
    if (term < 0) continue;
    const auto found = terms[static_cast<std::size_t>(term)].find("mass");
    if (found == terms[static_cast<std::size_t>(term)].end()) continue;
    for (std::size_t b = 0; b < num_bodies; ++b) {
      const double density = world_.bodies[b].density;
      const double alpha = term == inertia_ ? 1 : description_.bodies[b].damping.mass;
      const double slope =
          masses_of(b, alpha * density).add_slopes(*world_.mass, found->second, slopes.rest_positions);
      slopes.bodies[b].density += alpha * slope;
      if (term == mass_damping_) slopes.bodies[b].mass_damping += density * slope;
    }
  }
  for (const auto& [term, body] : viscous_)
    if (moves_viscosity(slopes, body))
      gather_viscosities(terms[term].find("viscosities")->second, body, slopes);
  contacts_.gather(terms, slopes);
  for (const BarrierLinks::Barrier& barrier : barriers_.all())
    if (BarrierLinks::moves(barrier, slopes))
      barriers_.gather(barrier, contacts_.stiffness_slopes(barrier.term, terms), slopes);
}

// In motion gravity is M g, at rest integral N_a rho g dV (world/loads.hpp).
void TermLinks::spread_gravity(const WorldChange& change, VectorX& forces) const {
  const int dim = world_.dimension;
  if (world_.is_dynamic) {
    VectorX product;
    world_.mass->multiply(change.gravity.head(dim).replicate(world_.num_nodes(), 1), product);
    forces += product;
    VectorX entries = VectorX::Zero(world_.mass->num_entries());
    for (std::size_t b = 0; change.has_mass() && b < world_.bodies.size(); ++b)
      masses_of(b, world_.bodies[b].density)
          .add_change(*world_.mass, change.bodies[b].density, change.rest_positions, entries);
    world_.mass->add_change(entries, world_.gravity.head(dim).replicate(world_.num_nodes(), 1), forces);
    return;
  }
  for (std::size_t b = 0; b < world_.bodies.size(); ++b) {
    const Body& body = world_.bodies[b];
    add_body_force(body.elastic->element(), body.cells, world_.rest_positions,
                   body.density * change.gravity + change.bodies[b].density * world_.gravity, forces);
    if (change.rest_positions.size() > 0)
      add_body_force_change(body.elastic->element(), body.cells, world_.rest_positions, change.rest_positions,
                            body.density * world_.gravity, forces);
  }
}

void TermLinks::gather_gravity(const VectorX& by_forces, WorldChange& slopes) const {
  const int dim = world_.dimension;
  const VectorX pull = world_.gravity.head(dim).replicate(world_.num_nodes(), 1);
  if (world_.is_dynamic) {
    VectorX product;
    world_.mass->multiply(by_forces, product);
    for (Index i = 0; i < world_.num_nodes(); ++i)
      slopes.gravity.head(dim) += product.segment(Eigen::Index{i} * dim, dim);
    if (!slopes.has_mass()) return;
    VectorX entries = VectorX::Zero(world_.mass->num_entries());
    world_.mass->add_slopes(by_forces, pull, entries);
    for (std::size_t b = 0; b < world_.bodies.size(); ++b)
      slopes.bodies[b].density +=
          masses_of(b, world_.bodies[b].density).add_slopes(*world_.mass, entries, slopes.rest_positions);
    return;
  }
  for (std::size_t b = 0; b < world_.bodies.size(); ++b) {
    const Body& body = world_.bodies[b];
    VectorX volumes = VectorX::Zero(by_forces.size());
    add_body_force(body.elastic->element(), body.cells, world_.rest_positions, Vector3::Ones(), volumes);
    const Vector3 by_pull = power_by_axis(volumes, by_forces, dim);
    slopes.gravity += body.density * by_pull;
    slopes.bodies[b].density += world_.gravity.dot(by_pull);
    if (slopes.rest_positions.size() > 0)
      add_body_force_slopes(body.elastic->element(), body.cells, world_.rest_positions,
                            body.density * world_.gravity, by_forces, slopes.rest_positions);
  }
}

// eta = shear + beta eta_rest and zeta = bulk - 2/3 shear + beta zeta_rest (world/damping.cpp).
void TermLinks::spread_viscosities(const WorldChange& change, std::size_t body, VectorX& viscosities) const {
  const WorldChange::OfBody& of = change.bodies[body];
  const double beta = description_.bodies[body].damping.stiffness;
  const ElasticEnergy& elastic = *world_.bodies[body].elastic;
  const Eigen::Index n = static_cast<Eigen::Index>(elastic.law().constants.size());
  const bool is_uniform = elastic.parameters().front().size == n;
  for (Eigen::Index cell = 0; 2 * cell < viscosities.size(); ++cell) {
    const Viscosity rest = rest_stiffness(elastic.material(static_cast<Index>(cell)));
    Eigen::Vector2d eta_zeta(
        of.shear_viscosity + of.stiffness_damping * rest.eta,
        of.bulk_viscosity - 2.0 / 3 * of.shear_viscosity + of.stiffness_damping * rest.zeta);
    if (of.constants.size() > 0 && beta != 0)
      eta_zeta += beta * rest_stiffness_slopes(elastic.material(static_cast<Index>(cell))) *
                  of.constants.segment(is_uniform ? 0 : cell * n, n);
    viscosities.segment<2>(2 * cell) += eta_zeta;
  }
}

void TermLinks::gather_viscosities(const VectorX& viscosities, std::size_t body, WorldChange& slopes) const {
  WorldChange::OfBody& of = slopes.bodies[body];
  const double beta = description_.bodies[body].damping.stiffness;
  const ElasticEnergy& elastic = *world_.bodies[body].elastic;
  const Eigen::Index n = static_cast<Eigen::Index>(elastic.law().constants.size());
  const bool is_uniform = elastic.parameters().front().size == n;
  for (Eigen::Index cell = 0; 2 * cell < viscosities.size(); ++cell) {
    const Viscosity rest = rest_stiffness(elastic.material(static_cast<Index>(cell)));
    const Eigen::Vector2d by = viscosities.segment<2>(2 * cell);
    of.shear_viscosity += by[0] - 2.0 / 3 * by[1];
    of.bulk_viscosity += by[1];
    of.stiffness_damping += by[0] * rest.eta + by[1] * rest.zeta;
    if (of.constants.size() > 0 && beta != 0)
      of.constants.segment(is_uniform ? 0 : cell * n, n) +=
          beta * rest_stiffness_slopes(elastic.material(static_cast<Index>(cell))).transpose() * by;
  }
}

}  // namespace resilin
