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
  using Kind = TermOrigin::Kind;
  for (std::size_t t = 0; t < world.origins.size(); ++t) {
    const auto& [kind, number, domain] = world.origins[t];
    if (kind == Kind::domain) elastic_.push_back({t, number, domain});
    if (kind == Kind::load) loads_.push_back(t);
    if (kind == Kind::spring || kind == Kind::cable) cables_.push_back(t);
    if (kind == Kind::gravity) gravity_ = static_cast<int>(t);
    if (kind == Kind::inertia) inertia_ = static_cast<int>(t);
    if (kind == Kind::viscous_damping) viscous_.push_back({t, number, domain});
    if (kind == Kind::mass_damping) mass_damping_ = static_cast<int>(t);
  }
}

CellMasses TermLinks::masses_of(std::size_t body, const Domain& domain, double density) const {
  const Body& of = world_.bodies[body];
  return {of.domains.element(), domain.cells, world_.rest_positions, density,
          of.mass_kind == MassKind::consistent};
}

bool TermLinks::moves_gravity(const WorldChange& change) const {
  return gravity_ >= 0 && (change.has_gravity || change.has_mass());
}

bool TermLinks::moves_viscosity(const WorldChange& change, const OfDomain& of) const {
  const WorldChange::OfBody& of_body = change.bodies[of.body];
  return of_body.has_damping || (of_body.domains[of.domain].constants.size() > 0 &&
                                 description_.bodies[of.body].damping.stiffness != 0);
}

TermChanges TermLinks::zero(const WorldChange& asked) const {
  TermChanges terms(world_.terms.size());
  const Eigen::Index num_unknowns = world_.rest_positions.size();
  const auto add = [&](std::size_t term, const std::string& name, Eigen::Index size) {
    terms[term][name] = VectorX::Zero(size);
  };
  for (const auto& [term, body, domain] : elastic_)
    if (const VectorX& constants = asked.bodies[body].domains[domain].constants; constants.size() > 0)
      add(term, "constants", constants.size());
  for (std::size_t l = 0; l < asked.loads.size(); ++l)
    for (const auto& [name, numbers] : asked.loads[l]) add(loads_[l], name, numbers.size());
  for (const auto& [term, of_term] : asked.couplings)
    for (const auto& [name, numbers] : of_term) add(term, name, numbers.size());
  const auto add_rest_positions = [&](std::size_t term) {
    for (const EnergyParameter& parameter : world_.terms[term]->parameters())
      if (parameter.name == "rest_positions") add(term, "rest_positions", num_unknowns);
  };
  if (asked.rest_positions.size() > 0) {
    for (const OfDomain& of : elastic_) add_rest_positions(of.term);
    for (const std::size_t term : loads_) add_rest_positions(term);
    for (const std::size_t term : cables_) add_rest_positions(term);
  }
  if (moves_gravity(asked)) add(static_cast<std::size_t>(gravity_), "forces", num_unknowns);
  if (inertia_ >= 0 && asked.has_mass())
    add(static_cast<std::size_t>(inertia_), "mass", world_.mass->num_entries());
  const bool changes_damping = std::ranges::any_of(asked.bodies, &WorldChange::OfBody::has_damping);
  if (mass_damping_ >= 0 && (asked.has_mass() || changes_damping))
    add(static_cast<std::size_t>(mass_damping_), "mass", world_.mass->num_entries());
  for (const OfDomain& of : viscous_) {
    const Index num_sets = description_.bodies[of.body].damping.stiffness == 0
                               ? 1
                               : world_.bodies[of.body].domains[of.domain].energy->num_cells();
    if (moves_viscosity(asked, of)) add(of.term, "viscosities", Eigen::Index{2} * num_sets);
    if (asked.rest_positions.size() > 0) add(of.term, "rest_positions", num_unknowns);
  }
  for (const BarrierLinks::Barrier& barrier : barriers_.all())
    if (barriers_.moves(barrier, asked)) add(barrier.term, "barrier_stiffness", barrier.stiffness.size());
  contacts_.add_zero(asked, terms);
  return terms;
}

TermChanges TermLinks::spread(const WorldChange& change) const {
  TermChanges terms = zero(change);
  for (const auto& [term, body, domain] : elastic_)
    if (const VectorX& constants = change.bodies[body].domains[domain].constants; constants.size() > 0)
      terms[term]["constants"] = constants;
  for (std::size_t l = 0; l < change.loads.size(); ++l)
    for (const auto& [name, numbers] : change.loads[l]) terms[loads_[l]][name] = numbers;
  for (const auto& [term, of_term] : change.couplings)
    for (const auto& [name, numbers] : of_term) terms[term][name] = numbers;
  for (std::map<std::string, VectorX, std::less<>>& of_term : terms)
    if (const auto found = of_term.find("rest_positions"); found != of_term.end())
      found->second = change.rest_positions;
  if (moves_gravity(change)) spread_gravity(change, terms[static_cast<std::size_t>(gravity_)]["forces"]);
  for (const int term : {inertia_, mass_damping_}) {
    if (term < 0) continue;
    const auto found = terms[static_cast<std::size_t>(term)].find("mass");
    if (found == terms[static_cast<std::size_t>(term)].end()) continue;
    for_each_domain(change, [&](std::size_t b, const Domain& domain, const WorldChange::OfDomain& of) {
      const double alpha = term == inertia_ ? 1 : description_.bodies[b].damping.mass;
      const double of_alpha = term == inertia_ ? 0 : change.bodies[b].mass_damping;
      masses_of(b, domain, alpha * domain.density)
          .add_change(*world_.mass, alpha * of.density + of_alpha * domain.density, change.rest_positions,
                      found->second);
    });
  }
  for (const OfDomain& of : viscous_)
    if (moves_viscosity(change, of)) spread_viscosities(change, of, terms[of.term]["viscosities"]);
  for (const BarrierLinks::Barrier& barrier : barriers_.all())
    if (barriers_.moves(barrier, change))
      barriers_.spread(barrier, change, terms[barrier.term]["barrier_stiffness"]);
  contacts_.spread(change, terms);
  return terms;
}

void TermLinks::gather(const TermChanges& terms, WorldChange& slopes) const {
  for (const auto& [term, body, domain] : elastic_)
    if (VectorX& constants = slopes.bodies[body].domains[domain].constants; constants.size() > 0)
      constants += terms[term].find("constants")->second;
  for (std::size_t l = 0; l < slopes.loads.size(); ++l)
    for (auto& [name, numbers] : slopes.loads[l]) numbers += terms[loads_[l]].find(name)->second;
  for (auto& [term, of_term] : slopes.couplings)
    for (auto& [name, numbers] : of_term) numbers += terms[term].find(name)->second;
  for (const std::map<std::string, VectorX, std::less<>>& of_term : terms)
    if (const auto found = of_term.find("rest_positions"); found != of_term.end())
      slopes.rest_positions += found->second;
  if (moves_gravity(slopes))
    gather_gravity(terms[static_cast<std::size_t>(gravity_)].find("forces")->second, slopes);
  for (const int term : {inertia_, mass_damping_}) {
    if (term < 0) continue;
    const auto found = terms[static_cast<std::size_t>(term)].find("mass");
    if (found == terms[static_cast<std::size_t>(term)].end()) continue;
    for_each_domain(slopes, [&](std::size_t b, const Domain& domain, WorldChange::OfDomain& of) {
      const double alpha = term == inertia_ ? 1 : description_.bodies[b].damping.mass;
      const double slope = masses_of(b, domain, alpha * domain.density)
                               .add_slopes(*world_.mass, found->second, slopes.rest_positions);
      of.density += alpha * slope;
      if (term == mass_damping_) slopes.bodies[b].mass_damping += domain.density * slope;
    });
  }
  for (const OfDomain& of : viscous_)
    if (moves_viscosity(slopes, of))
      gather_viscosities(terms[of.term].find("viscosities")->second, of, slopes);
  contacts_.gather(terms, slopes);
  for (const BarrierLinks::Barrier& barrier : barriers_.all())
    if (barriers_.moves(barrier, slopes))
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
    if (change.has_mass())
      for_each_domain(change, [&](std::size_t b, const Domain& domain, const WorldChange::OfDomain& of) {
        masses_of(b, domain, domain.density)
            .add_change(*world_.mass, of.density, change.rest_positions, entries);
      });
    world_.mass->add_change(entries, world_.gravity.head(dim).replicate(world_.num_nodes(), 1), forces);
    return;
  }
  for_each_domain(change, [&](std::size_t b, const Domain& domain, const WorldChange::OfDomain& of) {
    if (const Body& body = world_.bodies[b]; body.rigid) {
      for (Index node = body.first_node; node < body.first_node + body.num_nodes; ++node)
        forces.segment(Eigen::Index{node} * dim, dim) += world_.mass->nodal[node] * change.gravity.head(dim);
      return;
    }
    const ElementInfo& element = domain.energy->element();
    add_body_force(element, domain.cells, world_.rest_positions,
                   domain.density * change.gravity + of.density * world_.gravity, forces);
    if (change.rest_positions.size() > 0)
      add_body_force_change(element, domain.cells, world_.rest_positions, change.rest_positions,
                            domain.density * world_.gravity, forces);
  });
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
    for_each_domain(slopes, [&](std::size_t b, const Domain& domain, WorldChange::OfDomain& of) {
      of.density +=
          masses_of(b, domain, domain.density).add_slopes(*world_.mass, entries, slopes.rest_positions);
    });
    return;
  }
  for_each_domain(slopes, [&](std::size_t b, const Domain& domain, WorldChange::OfDomain& of) {
    if (const Body& body = world_.bodies[b]; body.rigid) {
      for (Index node = body.first_node; node < body.first_node + body.num_nodes; ++node)
        slopes.gravity.head(dim) +=
            world_.mass->nodal[node] * by_forces.segment(Eigen::Index{node} * dim, dim);
      return;
    }
    const ElementInfo& element = domain.energy->element();
    VectorX volumes = VectorX::Zero(by_forces.size());
    add_body_force(element, domain.cells, world_.rest_positions, Vector3::Ones(), volumes);
    const Vector3 by_pull = power_by_axis(volumes, by_forces, dim);
    slopes.gravity += domain.density * by_pull;
    of.density += world_.gravity.dot(by_pull);
    if (slopes.rest_positions.size() > 0)
      add_body_force_slopes(element, domain.cells, world_.rest_positions, domain.density * world_.gravity,
                            by_forces, slopes.rest_positions);
  });
}

// eta = shear + beta eta_rest and zeta = bulk - 2/3 shear + beta zeta_rest (world/damping.cpp).
void TermLinks::spread_viscosities(const WorldChange& change, const OfDomain& of_domain,
                                   VectorX& viscosities) const {
  const WorldChange::OfBody& of = change.bodies[of_domain.body];
  const VectorX& constants = of.domains[of_domain.domain].constants;
  const double beta = description_.bodies[of_domain.body].damping.stiffness;
  const ElasticEnergy& elastic = *world_.bodies[of_domain.body].domains[of_domain.domain].energy;
  const Eigen::Index n = static_cast<Eigen::Index>(elastic.law().constants.size());
  const bool is_uniform = elastic.parameters().front().size == n;
  for (Eigen::Index cell = 0; 2 * cell < viscosities.size(); ++cell) {
    const Viscosity rest = rest_stiffness(elastic.material(static_cast<Index>(cell)));
    Eigen::Vector2d eta_zeta(
        of.shear_viscosity + of.stiffness_damping * rest.eta,
        of.bulk_viscosity - 2.0 / 3 * of.shear_viscosity + of.stiffness_damping * rest.zeta);
    if (constants.size() > 0 && beta != 0)
      eta_zeta += beta * rest_stiffness_slopes(elastic.material(static_cast<Index>(cell))) *
                  constants.segment(is_uniform ? 0 : cell * n, n);
    viscosities.segment<2>(2 * cell) += eta_zeta;
  }
}

void TermLinks::gather_viscosities(const VectorX& viscosities, const OfDomain& of_domain,
                                   WorldChange& slopes) const {
  WorldChange::OfBody& of = slopes.bodies[of_domain.body];
  VectorX& constants = of.domains[of_domain.domain].constants;
  const double beta = description_.bodies[of_domain.body].damping.stiffness;
  const ElasticEnergy& elastic = *world_.bodies[of_domain.body].domains[of_domain.domain].energy;
  const Eigen::Index n = static_cast<Eigen::Index>(elastic.law().constants.size());
  const bool is_uniform = elastic.parameters().front().size == n;
  for (Eigen::Index cell = 0; 2 * cell < viscosities.size(); ++cell) {
    const Viscosity rest = rest_stiffness(elastic.material(static_cast<Index>(cell)));
    const Eigen::Vector2d by = viscosities.segment<2>(2 * cell);
    of.shear_viscosity += by[0] - 2.0 / 3 * by[1];
    of.bulk_viscosity += by[1];
    of.stiffness_damping += by[0] * rest.eta + by[1] * rest.zeta;
    if (constants.size() > 0 && beta != 0)
      constants.segment(is_uniform ? 0 : cell * n, n) +=
          beta * rest_stiffness_slopes(elastic.material(static_cast<Index>(cell))).transpose() * by;
  }
}

}  // namespace resilin
