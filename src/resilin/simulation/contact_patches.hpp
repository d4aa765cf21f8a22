#pragma once

#include "resilin/simulation/stage_solver.hpp"

namespace resilin {

/// The tolerance that the contact patches at x ask for, relative to the forces on their bodies; `tolerance`
/// where that is enough. A patch is a piece of a body whose nodes are touched and hang together in the
/// pattern. Large loads on a body would hide that the forces of a light touch elsewhere on it are wrong.
/// @param residual  of each part at most, relative to its forces
/// @param rounding  bound of the rounding of each force; empty: none [N]
double tolerance_of_patches(const World& world, const Potential& potential, const ConnectedComponents& parts,
                            const VectorX& x, double tolerance, double residual, const VectorX& rounding);

/// Continues a converged search of statics at a smaller tolerance where it leaves a patch unbalanced.
/// @param targets, settings, x, observer  as in `solve_stage`
void settle_patches(const World& world, Potential& potential, const VectorX& targets,
                    const NewtonSettings& settings, Newton& newton, VectorX& x, StageReport& searched,
                    const NewtonObserver& observer);

}  // namespace resilin
