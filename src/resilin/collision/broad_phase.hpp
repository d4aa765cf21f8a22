#pragma once

#include <span>

#include "resilin/collision/block_tree.hpp"
#include "resilin/collision/surface.hpp"
#include "resilin/core/cpu.hpp"

namespace resilin {

/// Finds the parts of surfaces that may come near each other.
///
/// Boxes around the ways of the parts stand in trees, built once and refitted for each search; blocks of
/// eight boxes go down the trees together. Parts that share a vertex, and bodies that do not meet, are left
/// out.
class BroadPhase {
 public:
  /// @param points  where the vertices stand, for the order in the trees
  BroadPhase(CollisionSurface surface, BodyMeetings meetings, std::span<const MovingPoint> points,
             InstructionSet set = preferred_instruction_set());

  /// Puts the parts into order anew: for bodies that have changed their shape or place a lot, whose search
  /// has become slow. What is found stays the same.
  void rebuild(std::span<const MovingPoint> points);

  /// All pairs of parts that may be within `distance` [m] of each other at the same time on their way from x
  /// to x + p, and some that are not: those whose boxes, with half of it all around, meet. The same, in the
  /// same order, whatever the order in the trees and the number of threads.
  /// @throws std::invalid_argument  when a vertex stands at or goes to no number, or beyond 1e30 m
  const SurfaceCandidates& find(std::span<const MovingPoint> points, double distance);

  const SurfaceCandidates& candidates() const { return candidates_; }  ///< found last
  const CollisionSurface& surface() const { return surface_; }
  const BodyMeetings& meetings() const { return meetings_; }
  void set_meetings(BodyMeetings meetings) { meetings_ = std::move(meetings); }

 private:
  CollisionSurface surface_;
  BodyMeetings meetings_;
  InstructionSet set_;
  BlockTree points_, edges_, triangles_;
  std::vector<BoxRow> vertex_rows_;
  SurfaceCandidates candidates_;
};

}  // namespace resilin
