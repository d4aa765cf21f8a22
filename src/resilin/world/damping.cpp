#include "resilin/world/damping.hpp"

#include <algorithm>

#include "resilin/energy/damping.hpp"
#include "resilin/world/rigid_shape.hpp"

namespace resilin {

Viscosity rest_stiffness(const Material& material) {
  const TangentMatrix<3> A = from_displacement_gradient::stress_tangent<3>(material, Matrix<3>::Zero());
  double sum_iijj = 0;  // 9 lambda + 6 mu
  double sum_ijij = 0;  // 3 lambda + 12 mu
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      sum_iijj += A(i + 3 * i, j + 3 * j);
      sum_ijij += A(i + 3 * j, i + 3 * j);
    }
  }
  return {.eta = (3 * sum_ijij - sum_iijj) / 30, .zeta = (2 * sum_iijj - sum_ijij) / 15};
}

namespace {

/// The viscosities that a body's `damping` asks for in a domain; empty when it asks for none.
std::vector<Viscosity> viscosities_of(const DampingDescription& damping, const ElasticEnergy& elastic) {
  if (damping.stiffness == 0 && damping.shear_viscosity == 0 && damping.bulk_viscosity == 0) return {};
  const Viscosity own{.eta = damping.shear_viscosity,
                      .zeta = damping.bulk_viscosity - 2.0 / 3 * damping.shear_viscosity};
  if (damping.stiffness == 0) return {own};
  std::vector<Viscosity> viscosities(static_cast<std::size_t>(elastic.num_cells()), own);
  for (std::size_t cell = 0; cell < viscosities.size(); ++cell) {
    const Viscosity rest = rest_stiffness(elastic.material(static_cast<Index>(cell)));
    viscosities[cell].eta += damping.stiffness * rest.eta;
    viscosities[cell].zeta += damping.stiffness * rest.zeta;
  }
  return viscosities;
}

}  // namespace

void add_damping(const Description& description, World& world) {
  const auto add = [&world](std::shared_ptr<const Energy> term, const TermOrigin& origin) {
    world.terms.push_back(std::move(term));
    world.origins.push_back(origin);
  };
  MassMatrix by_mass;
  for (std::size_t b = 0; b < world.bodies.size(); ++b) {
    const Body& body = world.bodies[b];
    const DampingDescription& wanted = description.bodies[b].damping;
    for (std::size_t d = 0; d < body.domains.size(); ++d)
      if (const std::vector<Viscosity> viscosities = viscosities_of(wanted, *body.domains[d].energy);
          !viscosities.empty())
        add(std::make_shared<ViscousDamping>(body.domains[d].energy, viscosities),
            {TermOrigin::Kind::viscous_damping, b, d});
    if (wanted.mass == 0) continue;
    if (by_mass.nodal.size() == 0) by_mass = world.mass->times(0);
    add_body_masses(by_mass, body, world.rest_positions, world.thickness * wanted.mass);
  }
  if (by_mass.nodal.size() > 0)
    add(std::make_shared<MassDamping>(std::make_shared<const MassMatrix>(std::move(by_mass))),
        {TermOrigin::Kind::mass_damping});
}

}  // namespace resilin
