#pragma once

#include "resilin/integrator/integrator.hpp"

namespace resilin {

/// Backward Euler: v = (x - x_n) / dt, a = (v - v_n) / dt. First order, dissipates, never blows up.
class BackwardEuler final : public Integrator {
 public:
  std::string_view name() const override { return "backward_euler"; }
  int order() const override { return 1; }

  Stage begin_stage(int, const History& start, const std::vector<Motion>&, double dt) const override {
    return {.base_positions = start.now.positions, .base_velocities = start.now.velocities, .duration = dt};
  }
};

}  // namespace resilin
