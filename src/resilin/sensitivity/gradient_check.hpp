#pragma once

#include <array>
#include <functional>
#include <string>
#include <vector>

#include "resilin/sensitivity/derivatives.hpp"
#include "resilin/sensitivity/difference_limit.hpp"

namespace resilin {

/// A derivative beside differences of runs.
struct GradientCheck {
  std::string parameter;
  Eigen::Index size = 1;  ///< how many numbers it has; of an array the slope is that along one change of all
  double slope = 0;       ///< slope of the result, from the transposed run
  std::array<double, 3> steps{};        ///< steps of the differences, relative to the size of the parameter
  std::array<double, 3> differences{};  ///< central ones
  double digits = 0;  ///< to which the best of them agrees, or what both shorter steps lead to
  /// Error bound of a difference, times the length of its step: because forces of its two runs balance to
  /// a tolerance, and because places are rounded.
  double noise = 0, rounding = 0;
  /// Limits of these and more differences, over other steps; empty: the three sufficed.
  DifferenceLimits limits{};

  enum class Verdict {
    agrees,
    is_within,  ///< the limit of differences has fewer digits, and within its error it is the derivative
    no_digits,  ///< the derivative is so small that differences hold none of its digits: they say nothing
    kink,    ///< differences to both sides lead to different slopes, no farther from it than these are apart
    open,    ///< differences lead nowhere: they say nothing
    differs  ///< they lead elsewhere: the derivative is wrong
  };
  Verdict verdict() const;
};

/// The result that is differentiated is a sum of all places of the last frame, each with a weight of its own
/// between -1 and 1. The scene's newton.tolerance is lowered to what differences need.
/// @param parameters  names; empty: all
/// @param warn        told what is odd about the derivatives, one line each
std::vector<GradientCheck> check_gradients(Description description, std::vector<std::string> parameters,
                                           const std::function<bool()>& goes_on = {},
                                           const std::function<void(const std::string&)>& warn = {});

}  // namespace resilin
