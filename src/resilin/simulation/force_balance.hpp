#pragma once

#include <cmath>
#include <span>
#include <string>
#include <vector>

#include "resilin/optimize/newton.hpp"
#include "resilin/simulation/potential.hpp"
#include "resilin/world/state.hpp"

namespace resilin {

/// Whether the forces on one body balance as a whole, by sums that the search for the equilibrium never
/// formed: what the supports exert against loads, contact, damping and inertia, in which the stresses do not
/// appear.
struct ForceBalance {
  Vector3 reaction = Vector3::Zero();  ///< reaction of all supports on the body [N]
  Vector3 load = Vector3::Zero();      ///< load of everything else that acts on it, inertia included [N]
  double scale = 0;                    ///< the largest force that takes part [N]

  double gap() const { return (reaction + load).norm(); }  ///< missing force [N]
};

/// Balances of each body of the world in one state.
/// @param gradient  of the energy of all terms there [N]
/// @param acting    of each term but the elastic ones [N] (`Potential::gradients_without`)
std::vector<ForceBalance> measure_balance(const World& world, const VectorX& gradient,
                                          std::span<const VectorX> acting);

/// Whether the strain energy of one body changes along a displacement by the work that the forces on it do
/// (the principle of virtual work), by differences of energies, in which the stresses that the search has
/// balanced do not appear.
struct WorkBalance {
  double strain_energy = 0;  ///< its change, for the whole displacement at the rate at x [J]
  double work = 0;           ///< work of supports and of everything else that acts, inertia included [J]
  double scale = 0;          ///< the largest of them, or of what they are made of [J]
  double rounding = 0;       ///< rounding of the forces, times the way [J]

  double gap() const { return std::abs(strain_energy - work); }  ///< missing energy [J]
};

/// For each body of the world at x along `displacement` [m], which begins or ends there; `gradient` and
/// `acting` are those of `potential` at x, as above.
std::vector<WorkBalance> measure_work(const World& world, const Potential& potential, const VectorX& x,
                                      const VectorX& gradient, std::span<const VectorX> acting,
                                      const VectorX& displacement);

/// A step whose bodies are farther out of balance than this has not been solved.
constexpr double largest_balance_error = 1e-3;

/// Names the first body that is out of balance after a search that converged, with its numbers; empty when
/// all balance. What rounding leaves (`report.rounding`) is not missed.
/// @param displacement  along which work is compared, too [m]; empty: of forces alone
std::string describe_imbalance(const World& world, const Potential& potential, const VectorX& x,
                               const VectorX& gradient, const NewtonReport& report,
                               const VectorX& displacement = {});

/// Bound of the rounding of sums and of positions for each force in an equilibrium (docs/theory/stopping.md,
/// S.2) [N].
VectorX rounding_of_forces(const World& world, const Potential& potential, const ConnectedComponents& parts,
                           const VectorX& x, const VectorX& gradient);

/// Sets forces to zero in the parts whose supports exert less than rounding lets a search balance.
void drop_rounding(const World& world, const Potential& potential, const VectorX& x, VectorX& gradient);

/// An equilibrium whose bodies are farther out of balance than this is told of, with what is missing.
constexpr double notable_balance_error = 1e-6;

/// One line for each body at rest whose forces balance no better than rounding lets them, or than ten times
/// newton.tolerance.
std::vector<std::string> describe_lost_digits(const World& world, const State& state);

}  // namespace resilin
