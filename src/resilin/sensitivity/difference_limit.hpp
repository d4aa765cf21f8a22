#pragma once

#include <limits>
#include <vector>

namespace resilin {

/// Differences of a function over a step to both sides of a place, divided by it.
struct SampledDifference {
  double step;
  double before, after;  ///< on the side of -step and of +step
};

/// Where quotients go as their steps become shorter, and about how far that is off. Not a number: nowhere.
struct DifferenceLimit {
  double value = std::numeric_limits<double>::quiet_NaN();
  double error = std::numeric_limits<double>::infinity();
};

/// Limits that samples give for a derivative, which need not exist: where there is a kink both sides have
/// their own. Extrapolated from each step and the next shorter one (Richardson 1911), central quotients by
/// the square of the step, those of one side by the step itself. Of the extrapolations the one is taken that
/// is nearest to its neighbour: the longer steps bend, the shorter ones have noise.
struct DifferenceLimits {
  DifferenceLimit central, before, after;

  /// Whether both sides go to slopes of their own.
  bool are_kinked() const;
};

/// @param samples  in any order; those that are not finite count nowhere
DifferenceLimits limits_of(std::vector<SampledDifference> samples);

}  // namespace resilin
