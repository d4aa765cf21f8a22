#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "resilin/collision/broad_phase.hpp"
#include "resilin/core/types.hpp"

namespace resilin {

/// Finds candidates for vertices in a region, and anew only when they leave it.
class ContactSearch {
 public:
  /// @param trees     copied before the first search, and not where boxes around bodies tell that none meet
  /// @param distance  of parts that are to be found [m]
  ContactSearch(std::shared_ptr<const BroadPhase> trees, double distance)
      : trees_(std::move(trees)), distance_(distance) {}

  /// Makes the candidates all pairs that may be within the distance of each other while every vertex is in
  /// the box around its way between two places, or a little outside.
  /// @return whether it searched: else the candidates are those from before
  bool cover(const VectorX& from, const VectorX& to);

  const SurfaceCandidates& candidates() const {
    return own_trees_ && has_any_ ? own_trees_->candidates() : none();
  }
  const CollisionSurface& parts() const { return trees_->surface(); }

 private:
  static const SurfaceCandidates& none();
  bool covers(const VectorX& places) const;
  bool may_meet() const;
  double slack() const;  ///< [m]

  std::shared_ptr<const BroadPhase> trees_;
  double distance_;
  std::optional<BroadPhase> own_trees_;
  std::vector<MovingPoint> ways_;  ///< ways of the last search
  bool has_any_ = false;           ///< it found boxes of bodies that meet
};

}  // namespace resilin
