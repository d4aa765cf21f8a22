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
  int num_stages() const override { return 2; }
  bool needs_accelerations() const override { return true; }

  Stage begin_stage(int stage, const History& start, const std::vector<Motion>& solutions,
                    double dt) const override {
    constexpr double g = 2 - std::numbers::sqrt2;
    const double c = 0.5 * g * dt;
    if (stage == 0) {
      return {.base_positions = start.now.positions + c * start.now.velocities,
              .base_velocities = start.now.velocities + c * start.now.accelerations,
              .duration = c,
              .time_fraction = g};
    }
    constexpr double a1 = 1 / (g * (2 - g));
    constexpr double a2 = (1 - g) * (1 - g) / (g * (2 - g));
    return {.base_positions = a1 * solutions[0].positions - a2 * start.now.positions,
            .base_velocities = a1 * solutions[0].velocities - a2 * start.now.velocities,
            .duration = c};
  }
};

}  // namespace resilin
