#pragma once

#include <array>
#include <functional>
#include <string>
#include <vector>

#include "resilin/sensitivity/derivatives.hpp"

namespace resilin {

/// A derivative beside differences of runs.
struct GradientCheck {
  std::string parameter;
  Eigen::Index size = 1;  ///< how many numbers it has; of an array the slope is that along one change of all
  double slope = 0;       ///< of the result, from the transposed run
  std::array<double, 3> steps{};        ///< of the differences, relative to the size of the parameter
  std::array<double, 3> differences{};  ///< central ones
  double digits = 0;                    ///< to which the best of them agrees

  /// Differences of runs carry some eight digits at best; a wrong derivative has none or one.
  bool agrees() const { return digits >= 4; }
};

/// The result that is differentiated is a sum of all places of the last frame, each with a weight of its own
/// between -1 and 1. The scene's newton.tolerance is lowered to what differences need.
/// @param parameters  names; empty: all
/// @param done        told of each as soon as it is checked
std::vector<GradientCheck> check_gradients(Description description, std::vector<std::string> parameters,
                                           const std::function<bool()>& goes_on = {},
                                           const std::function<void(const GradientCheck&)>& done = {});

}  // namespace resilin
