#pragma once

#include "resilin/simulation/stage_solver.hpp"

namespace resilin {

/// What may be left unbalanced at a contact patch, relative to the contact forces on it.
constexpr double largest_patch_error = 1e-3;

/// The largest residual at a contact patch, relative to the contact and friction forces on it. A patch is a
/// piece of a body whose nodes are touched and hang together in the pattern. The residual of a body that
/// carries large loads may hide that a light touch elsewhere on it is not in balance.
/// @param residual  of each part, relative to its forces. Patches for which this is small enough are skipped
/// @param rounding  bound of the rounding of each force; empty: none [N]
double worst_patch(const World& world, const Potential& potential, const ConnectedComponents& parts,
                   const VectorX& x, double residual, const VectorX& rounding);

/// Continues a converged search of statics at a smaller tolerance where it leaves a patch unbalanced.
/// @param targets, settings, x, observer  as in `solve_stage`
void settle_patches(const World& world, Potential& potential, const VectorX& targets,
                    const NewtonSettings& settings, Newton& newton, VectorX& x, StageReport& searched,
                    const NewtonObserver& observer);

}  // namespace resilin
