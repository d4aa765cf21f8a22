#pragma once

#include <limits>

#include "resilin/optimize/newton.hpp"
#include "resilin/simulation/potential.hpp"

namespace resilin {

/// How long the search for one stage may take.
struct StageBudget {
  /// After this no further Newton iteration begins; at least one is done [s].
  double seconds = std::numeric_limits<double>::infinity();
  int iterations = std::numeric_limits<int>::max();  ///< the same for this number of them
  int friction_rounds = 0;  ///< so often the normal forces of friction are formed anew and the search goes on
};

/// Where a stage would end if nothing held the bodies back.
struct Flight {
  VectorX places{};              ///< [m]; empty where the search is to begin where it is told
  const World* world = nullptr;  ///< world of the flying bodies; null in statics, where none does
};

/// Where the stage would end without forces; bodies that fly, held by no support and about as heavy as their
/// weight when they stand at x, are where gravity takes them: M a = M g, whatever the mass matrix.
/// @param gravity  that of a term of the potential [m/s^2]
Flight flight(const World& world, std::span<const std::uint8_t> is_fixed, const Potential& potential,
              const Stage& stage, const Vector3& gravity, const VectorX& x);

/// Result of one stage of a step.
struct StageReport {
  NewtonReport newton;  ///< counts of all searches
  bool flew = false;    ///< the search began at the flight
  /// After a converged search: how far forces are out of balance, beside those that act, once friction is
  /// that of the place where it ended. 0: no farther than the tolerance.
  double friction_mismatch = 0;
  int friction_rounds = 0;  ///< searches that went on with friction formed anew
};

/// Newton's method on one stage of a step, for runs and for scenes that are played with.
///
/// Starts from the flight or from x, whichever has the lower energy. Free bodies of a search that ends early
/// are moved as rigid ones to where they fly, as found or in their shape at x, where that lowers the energy:
/// so they keep their momenta, however little of their deformation was found. Where bodies are in the way of
/// what moves by itself (colliders), the search leads it on and them with it:
/// `potential.conditions().delay` is how far it is behind at first, and becomes how far it still is.
///
/// The normal forces of friction are at first those at x; then they are formed where a search ended, and it
/// goes on from there, until that leaves the forces in balance. The potential keeps those of the place found.
///
/// @param targets  places of the fixed unknowns
/// @param x        the start, and what is found
/// @return         a search that the budget ended is `interrupted`, as is one that the observer ended, unless
///                 its last iteration solved the stage
StageReport solve_stage(Potential& potential, std::span<const std::uint8_t> is_fixed, const VectorX& targets,
                        const Flight& flight, const NewtonSettings& settings, const StageBudget& budget,
                        Newton& newton, VectorX& x, const NewtonObserver& observer = {});

}  // namespace resilin
