#pragma once

#include "resilin/integrator/integrator.hpp"

namespace resilin {

/// Newmark with beta = 1/4, gamma = 1/2, the trapezoidal rule:
///
///   x = x_n + dt/2 (v_n + v),   v = v_n + dt/2 (a_n + a)
///
/// Second order; neither damps nor feeds small vibrations. Source: Newmark 1959.
class Newmark final : public Integrator {
 public:
  std::string_view name() const override { return "newmark"; }
  int order() const override { return 2; }
  bool needs_accelerations() const override { return true; }

  Stage begin_stage(int, const History& start, const std::vector<Motion>&, double dt) const override {
    return {.base_positions = start.now.positions + 0.5 * dt * start.now.velocities,
            .base_velocities = start.now.velocities + 0.5 * dt * start.now.accelerations,
            .duration = 0.5 * dt};
  }
};

}  // namespace resilin
