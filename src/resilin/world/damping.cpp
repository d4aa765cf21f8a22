#include "resilin/world/damping.hpp"

#include <algorithm>

#include "resilin/energy/inertia.hpp"

namespace resilin {
namespace {

/// Lame's constants of the isotropic solid nearest to the rest stiffness (its Voigt average), which is the
/// rest stiffness itself for a law without fibres.
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

/// The viscosities that a body's `damping` asks for; null when it asks for none.
std::shared_ptr<const ViscousBody> make_viscous_body(const DampingDescription& damping, const World& world,
                                                     const Body& body) {
  if (damping.stiffness == 0 && damping.shear_viscosity == 0 && damping.bulk_viscosity == 0) return nullptr;
  const Viscosity own{.eta = damping.shear_viscosity,
                      .zeta = damping.bulk_viscosity - 2.0 / 3 * damping.shear_viscosity};
  std::vector<Viscosity> viscosities(static_cast<std::size_t>(damping.stiffness == 0 ? 1 : body.num_cells()),
                                     own);
  if (damping.stiffness > 0) {
    for (std::size_t cell = 0; cell < viscosities.size(); ++cell) {
      const Viscosity rest = rest_stiffness(body.elastic->material(static_cast<Index>(cell)));
      viscosities[cell].eta += damping.stiffness * rest.eta;
      viscosities[cell].zeta += damping.stiffness * rest.zeta;
    }
  }
  return std::make_shared<const ViscousBody>(world.dimension, body.elastic->element(),
                                             body.elastic->quadrature(), body.cells, world.rest_positions,
                                             std::move(viscosities));
}

}  // namespace

void add_damping(const Description& description, World& world) {
  MassMatrix& damping = world.mass_damping;
  for (std::size_t b = 0; b < world.bodies.size(); ++b) {
    const Body& body = world.bodies[b];
    const DampingDescription& wanted = description.bodies[b].damping;
    if (auto viscous = make_viscous_body(wanted, world, body))
      world.viscous_bodies.push_back(std::move(viscous));
    if (wanted.mass == 0) continue;
    if (damping.nodal.size() == 0) {
      damping = world.mass;
      damping.nodal.setZero();
      std::ranges::fill(damping.slots, 0.0);
    }
    add_cell_masses(damping, body.elastic->element(), body.cells, world.rest_positions,
                    wanted.mass * body.density, body.mass_kind == "consistent");
  }
}

std::vector<std::unique_ptr<Energy>> damping_terms(const World& world, const VectorX& at,
                                                   const VectorX& base_positions, double duration) {
  std::vector<std::unique_ptr<Energy>> terms;
  // c/2 v^T D v with D = alpha M and v = (x - x_0) / c has the form of an inertia with s = c.
  if (world.mass_damping.nodal.size() > 0)
    terms.push_back(std::make_unique<Inertia>(world.mass_damping, base_positions, duration));
  for (const auto& body : world.viscous_bodies)
    terms.push_back(std::make_unique<StageDamping>(*body, at, base_positions, duration));
  return terms;
}

}  // namespace resilin
