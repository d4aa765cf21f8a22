#pragma once

#include "resilin/simulation/potential.hpp"
#include "resilin/world/state.hpp"

/// No step may add energy: what the guard asks and what it does (docs/theory/integrators.md, I.7).
namespace resilin {

/// Energies before and after a step [J].
struct EnergyChange {
  double kinetic_before = 0, kinetic_after = 0;  ///< kinetic energy before and after, of the free DOFs [J]
  double added = 0;        ///< beyond the work done on the bodies [J]; infinite outside the energies' domain
  bool is_driven = false;  ///< work was done; where there is a choice, `added` is the least that it may be
};

/// How a step from `start` changes the energy. Work is done by loads that follow time, colliders and supports
/// that move.
/// @param after  the conditions at the end
EnergyChange energy_change(const World& world, const State& start, const Motion& end,
                           const Conditions& after);

/// Bound of the round-off in the energy of bodies [J]: a strain of 1e-10 everywhere, and what digits of the
/// places make of velocities.
double round_off_energy(const World& world, double strain_stiffness, const VectorX& positions,
                        double time_step);
/// The strain energy of a small uniform strain, over its square [J].
double strain_stiffness(const World& world);

/// Slows velocities down until they have lost `excess` [J]: where `only_within` is set, only what bodies
/// without supports do besides moving as rigid ones, so that their momenta are kept, else everything. Bodies
/// that ties or joints couple count as one.
/// @return whether that was possible; else nothing is changed
bool slow_down(const World& world, const VectorX& positions, double excess, bool only_within,
               VectorX& velocities);

}  // namespace resilin
