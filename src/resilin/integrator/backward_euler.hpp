#pragma once

#include "resilin/integrator/integrator.hpp"

namespace resilin {

/// Backward Euler: x~ = x_n + dt v_n, s = dt^2, v = (x - x_n) / dt. First order, dissipates, never blows up.
class BackwardEuler final : public Integrator {
 public:
  std::string_view name() const override { return "backward_euler"; }
  int num_stages() const override { return 1; }

  Stage begin_stage(int, const Motion& start, const std::vector<VectorX>&, double dt) const override {
    return {.target = start.positions + dt * start.velocities, .scale = dt * dt, .time_fraction = 1};
  }

  Motion finish(const Motion& start, const std::vector<VectorX>& solutions, double dt) const override {
    return {.positions = solutions.back(), .velocities = (solutions.back() - start.positions) / dt};
  }
};

}  // namespace resilin
