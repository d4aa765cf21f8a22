#pragma once

#include <span>
#include <vector>

#include "resilin/collision/candidates.hpp"
#include "resilin/collision/moving_point.hpp"
#include "resilin/core/cpu.hpp"

namespace resilin {

/// Accuracy of collision times (continuous collision detection).
struct CollisionTimeOptions {
  double share_left =
      0.1;  ///< fraction of its distance at the start that a pair keeps at its time; in (0, 1)
  double tolerance = 0.05;   ///< how much more may be left, as a share of the same distance
  int max_iterations = 100;  ///< maximum iterations of one pair; fewer only make its time earlier
};

/// For each candidate a time t in [0, 1] such that its parts stay apart on all of [0, t] by at least
/// `share_left` of their distance at the start: 1 where the whole way is free, 0 where they touch at the
/// start or are closer than round-off in their coordinates tells. Never late, whatever the round-off, also of
/// the sums x + t p that the caller forms; not a number counts as touching.
/// The distance at the start is the width of the first slab below, which is less than the true one only
/// where that is under 1e-7 of the parts' size.
///
/// Conservative advancement: at some time the parts lie on both sides of a slab; as long as it moves along no
/// normal but its own, they stay outside of it until the first vertex has used up its room, which is a linear
/// equation for each pair of vertices. From there on the next slab. The bound holds for any normal, so that
/// it does not matter how well the closest points are known; motion along the slab costs nothing. Sources:
/// Mirtich 1996, "Impulse-based Dynamic Simulation", 3.2 (advancement); Li, Kaufman & Jiang 2021,
/// "Codimensional Incremental Potential Contact", 5 (additive, what is left as a share of the start).
void collision_times(const CandidateList& candidates, std::span<const MovingPoint> points,
                     std::span<double> times, const CollisionTimeOptions& options = {},
                     InstructionSet set = preferred_instruction_set());

/// The least of these times, 1 without candidates: quicker, for each candidate is followed only up to the
/// least so far. The same bits for any number of threads.
double earliest_collision_time(const CandidateList& candidates, std::span<const MovingPoint> points,
                               const CollisionTimeOptions& options = {},
                               InstructionSet set = preferred_instruction_set());

/// The squared distances of candidates at x [m^2].
void squared_distances(const CandidateList& candidates, std::span<const MovingPoint> points,
                       std::span<double> squares, InstructionSet set = preferred_instruction_set());

}  // namespace resilin
