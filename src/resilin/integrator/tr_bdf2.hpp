#pragma once

#include <numbers>

#include "resilin/integrator/integrator.hpp"

namespace resilin {

/// The trapezoidal rule up to the part g = 2 - sqrt(2) of the step, then backward differences over both
/// parts:
///
///   x_g = x_n + c (v_n + v_g),   x = a1 x_g - a2 x_n + c v,   c = g dt / 2,
///   a1 = 1 / (g (2 - g)),   a2 = (1 - g)^2 / (g (2 - g))
///
/// and the same from accelerations to velocities. Both stages have the same s = c^2. Second order with a
/// small error; dissipates what the step does not resolve. Source: Bank et al. 1985; Hosea & Shampine 1996.
class TrBdf2 final : public Integrator {
 public:
  std::string_view name() const override { return "tr_bdf2"; }
  int order() const override { return 2; }

  StepCoefficients coefficients(double) const override {
    constexpr double g = 2 - std::numbers::sqrt2;
    constexpr double c = 0.5 * g;
    constexpr double a1 = 1 / (g * (2 - g));
    constexpr double a2 = (1 - g) * (1 - g) / (g * (2 - g));
    return {.stages = {{.duration = c, .time_fraction = g, .start = {.value = 1, .slope = c}},
                       {.duration = c, .start = {.value = -a2}, .stages = {{.value = a1}}}}};
  }
};

}  // namespace resilin
