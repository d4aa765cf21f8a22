#pragma once

#include "resilin/contact/term_sums.hpp"

namespace resilin {

/// Forces on the vertices [N] that lead a way around what it would run into only because surfaces turn on it.
///
/// Newton's step p moves a pair to the distance d + grad d . p. Edges that slide along each other while they
/// turn may meet before, although that is positive: then steps are cut to about the root of d, and where d is
/// small the search creeps. For each such pair the force is k e grad d: k the curvature of its barrier, grad
/// d that where the parts meet, and e what its distance at the end, by the velocity there, is short of d +
/// grad d . p. So the inverse of the Hessian, in which k stands along grad d, turns them into a correction by
/// which the pair keeps its distance. Source: Nocedal & Wright 2006, 18.3 (second-order correction; the
/// Maratos effect).
/// @param set            all terms, not merged ones: whole parts
/// @param places         of the vertices [m]
/// @param displacements  of the vertices, the whole way [m]
/// @return empty where no way of these terms is cut short
VectorX second_order_forces(const TermSet& set, const VectorX& places, const VectorX& displacements);

}  // namespace resilin
