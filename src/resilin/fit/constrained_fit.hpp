#pragma once

#include <vector>

#include "resilin/fit/drucker.hpp"
#include "resilin/fit/separable_fit.hpp"

namespace resilin {

/// Constraints of the constants: limits of c and v, and Drucker's condition at some states.
struct FitLimits {
  std::vector<LoadedState> stable_states;  ///< empty: stability is not asked for
};

/// A point within the limits, and what holds it there.
struct BoundedPoint : FitPoint {
  /// Slopes of the limits that are reached, by (c, v): a row for each.
  DenseMatrix reached;
  bool is_held_by_stability = false, is_held_by_range = false;
};

/// Whether a point keeps to the limits.
bool keeps_limits(const LawProblem& problem, const FitLimits& limits, const FitPoint& point);

/// The smallest sum of squares within the limits, from `start`, which need not keep to them.
///
/// False when no point within the limits was found.
bool fit_within_limits(const LawProblem& problem, const FitLimits& limits, const FitPoint& start,
                       BoundedPoint& point);

}  // namespace resilin
