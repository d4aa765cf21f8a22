#pragma once

#include "resilin/integrator/integrator.hpp"

namespace resilin {

/// Backward Euler: v = (x - x_n) / dt, a = (v - v_n) / dt. First order, dissipates, never blows up.
class BackwardEuler final : public Integrator {
 public:
  std::string_view name() const override { return "backward_euler"; }
  int order() const override { return 1; }
  StepCoefficients coefficients(double) const override { return {.stages = {{.duration = 1}}}; }
};

}  // namespace resilin
