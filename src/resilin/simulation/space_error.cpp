#include "resilin/simulation/space_error.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "resilin/linear/minres.hpp"
#include "resilin/simulation/body_space.hpp"
#include "resilin/simulation/potential.hpp"
#include "resilin/simulation/time_stepping.hpp"
#include "resilin/world/axisymmetry.hpp"

namespace resilin {
namespace {

constexpr double most_bytes = 512e6;      ///< for the tangents of all bodies
constexpr int most_iterations = 30;       ///< iterations of conjugate gradients
constexpr double least_gain = 0.03;       ///< least relative gain of energy by an iteration
constexpr double solve_tolerance = 1e-2;  ///< tolerance for the element's own unknowns
/// Where they hold pressures, which a nearly incompressible solid makes large.
constexpr double mixed_solve_tolerance = 1e-6;
constexpr int most_saddle_iterations = 100;  ///< iterations of the minimum residual method
constexpr double saddle_tolerance = 0.1;     ///< the estimate is off by its square
/// The least share of the sizes of both changes that is told where they cancel. This and the next two were
/// measured on random bars and blocks (docs/theory/discretisation.md).
constexpr double least_share_left = 0.2;
/// Cubic functions find less than all of what P2P0 lacks, linear pressures more: no quadratic ones answer
/// them.
constexpr double whole_of_cubic = 1.1, whole_of_linear_pressures = 0.9;

using Apply = std::function<bool(const VectorX& v, VectorX& image)>;
using Precondition = std::function<void(const VectorX& r, VectorX& z)>;

/// Conjugate gradients, until an iteration adds little to the energy.
/// @return  zero: d . r is the energy that was found
std::optional<VectorX> solve_definite(const Apply& apply, const Precondition& precondition,
                                      const VectorX& right_side, VectorX& d) {
  VectorX residual = right_side, z, image;
  d.setZero(right_side.size());
  precondition(residual, z);
  VectorX direction = z;
  double product = residual.dot(z), energy = 0;
  for (int iteration = 0; iteration < most_iterations && product > 0; ++iteration) {
    if (!apply(direction, image)) return std::nullopt;
    const double curvature = direction.dot(image);
    if (!(curvature > 0)) break;
    const double step = product / curvature, gain = step * product;
    d += step * direction;
    residual -= step * image;
    energy += gain;
    if (gain < least_gain * energy) break;
    precondition(residual, z);
    const double next = residual.dot(z);
    direction = z + next / product * direction;
    product = next;
  }
  return VectorX(VectorX::Zero(right_side.size()));
}

/// The minimum residual method where pressures make a saddle point of it.
/// @return  the residual: d . (r + residual) is the stationary value up to its square
std::optional<VectorX> solve_saddle(const Apply& apply, const Precondition& precondition,
                                    const VectorX& right_side, VectorX& d) {
  const bool is_solved = minres(apply, precondition, right_side,
                                {.max_iterations = most_saddle_iterations, .tolerance = saddle_tolerance}, d);
  VectorX image;
  if (!is_solved || !apply(d, image)) return std::nullopt;
  return VectorX(right_side - image);
}

template <int dim>
std::optional<SpaceError> space_error_in(Simulation& simulation) {
  const World& world = simulation.world();
  const VectorX& x = simulation.state().positions;
  const Conditions conditions = world.at_load(simulation.state().load);
  Potential potential = Potential::at(world, conditions, x);
  potential.form_lag(x);
  const VectorX contact =
      potential.gradient_of(EnergyCategory::contact, x) + potential.gradient_of(EnergyCategory::friction, x);
  const DistributedLoads loads = distributed_loads(world, x, conditions);

  const bool has_free_unknowns = world.num_free_unknowns() > 0;
  // The matrix of the line search is not near enough: large rotations of the last steps would make S
  // indefinite.
  if (has_free_unknowns) simulation.newton().form_matrix(potential, world.is_fixed, x);

  SpaceError error;
  error.changes.resize(world.bodies.size());
  std::vector<BodySpace<dim>> spaces;
  std::vector<std::size_t> numbers;
  Eigen::Index num_unknowns = 0;
  double bytes = 0;
  for (std::size_t b = 0; b < world.bodies.size(); ++b) {
    const Body& body = world.bodies[b];
    if (body.num_cells() == 0 || body.rigid) continue;
    BodySpace<dim> space(world, body);
    if (bytes + space.bytes() > most_bytes) continue;
    bytes += space.bytes();
    space.fix(contact);
    if (!space.form(x, loads, loads.bodies[b])) continue;
    num_unknowns += space.num_unknowns();
    spaces.push_back(std::move(space));
    numbers.push_back(b);
  }
  if (spaces.empty()) return std::nullopt;

  const auto for_spaces = [&](const auto& visit) {
    Eigen::Index begin = 0;
    for (const BodySpace<dim>& space : spaces) {
      visit(space, begin);
      begin += space.num_unknowns();
    }
  };
  const bool is_mixed = std::ranges::any_of(spaces, [](const auto& space) { return space.is_mixed(); });
  // S v = K_bb v - K_bh K_hh^-1 K_hb v. False where K_hh cannot be solved with.
  const auto schur = [&](const VectorX& v, VectorX& image) {
    VectorX forces = VectorX::Zero(x.size());
    image.resize(num_unknowns);
    for_spaces([&](const BodySpace<dim>& space, Eigen::Index begin) {
      space.apply(v.segment(begin, space.num_unknowns()), image.segment(begin, space.num_unknowns()), forces);
    });
    if (!has_free_unknowns) return true;
    const std::optional<VectorX> z = simulation.newton().response(
        std::move(forces), world.is_fixed, is_mixed ? mixed_solve_tolerance : solve_tolerance);
    if (!z) return false;
    for_spaces([&](const BodySpace<dim>& space, Eigen::Index begin) {
      space.subtract_coupling(*z, image.segment(begin, space.num_unknowns()));
    });
    return true;
  };
  const auto precondition = [&](const VectorX& r, VectorX& z) {
    z.resize(num_unknowns);
    for_spaces([&](const BodySpace<dim>& space, Eigen::Index begin) {
      space.precondition(r.segment(begin, space.num_unknowns()), z.segment(begin, space.num_unknowns()));
    });
  };
  VectorX right_side(num_unknowns), d;
  for_spaces([&](const BodySpace<dim>& space, Eigen::Index begin) {
    right_side.segment(begin, space.num_unknowns()) = space.residual();
  });
  const std::optional<VectorX> left = is_mixed ? solve_saddle(schur, precondition, right_side, d)
                                               : solve_definite(schur, precondition, right_side, d);
  if (!left) return std::nullopt;
  Eigen::Index begin = 0;
  for (std::size_t i = 0; i < spaces.size(); ++i) {
    const Eigen::Index size = spaces[i].num_unknowns();
    SpaceError::Change change = spaces[i].change(
        d.segment(begin, size).cwiseProduct(right_side.segment(begin, size) + left->segment(begin, size)));
    if (!spaces[i].is_mixed()) change.by_displacements = std::max(0.0, change.by_displacements);
    if (spaces[i].is_mixed() && world.bodies[numbers[i]].domains.element().degree > 1) {
      change.by_displacements *= whole_of_cubic;
      change.by_pressures *= whole_of_linear_pressures;
    }
    error.changes[numbers[i]] = change;
    begin += size;
  }

  const VectorX displacement = x - world.rest_positions;
  VectorX gradient;
  potential.gradient(x, gradient);
  double work_of_supports = -contact.dot(displacement);
  for (Eigen::Index i = 0; i < x.size(); ++i)
    if (world.is_fixed[static_cast<std::size_t>(i)] != 0) work_of_supports += gradient[i] * displacement[i];
  const double work_of_loads = -potential.gradient_of(EnergyCategory::external, x).dot(displacement);
  error.is_driven_by_displacements = std::abs(work_of_supports) > std::abs(work_of_loads);
  return error;
}

}  // namespace

double SpaceError::Change::total() const {
  const double sum = by_displacements + by_pressures;
  const double least = least_share_left * (std::abs(by_displacements) + std::abs(by_pressures));
  return std::abs(sum) < least ? std::copysign(least, sum) : sum;
}

std::optional<SpaceError> space_error(Simulation& simulation) {
  const World& world = simulation.world();
  if (world.is_dynamic || world.modes || !world.share.is_whole() || world.keeps_history() ||
      world.constraints || !world.cables.empty() || is_axisymmetric(world) || world.thickness != 1)
    return std::nullopt;
  return world.dimension == 3 ? space_error_in<3>(simulation) : space_error_in<2>(simulation);
}

}  // namespace resilin
