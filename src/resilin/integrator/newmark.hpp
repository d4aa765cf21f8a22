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

  StepCoefficients coefficients(double) const override {
    return {.stages = {{.duration = 0.5, .start = {.value = 1, .slope = 0.5}}}};
  }
};

}  // namespace resilin
