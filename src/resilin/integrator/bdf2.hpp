#pragma once

#include "resilin/integrator/integrator.hpp"

namespace resilin {

/// Backward differences over two steps, of the lengths dt_n and dt with r = dt / dt_n:
///
///   x = a1 x_n - a2 x_(n-1) + c v
///   a1 = (1 + r)^2 / (1 + 2r),   a2 = r^2 / (1 + 2r),   c = dt (1 + r) / (1 + 2r)
///
/// and the same from accelerations to velocities; the first step, r = 0, is one of backward Euler. Second
/// order, dissipates what the step does not resolve. For equal steps a1 = 4/3, a2 = 1/3, c = 2/3 dt.
/// Source: Hairer, Norsett & Wanner 1993, sec. III.5.
class Bdf2 final : public Integrator {
 public:
  std::string_view name() const override { return "bdf2"; }
  int order() const override { return 2; }

  StepCoefficients coefficients(double r) const override {
    const double a1 = (1 + r) * (1 + r) / (1 + 2 * r);
    const double a2 = r * r / (1 + 2 * r);
    return {.stages = {{.duration = (1 + r) / (1 + 2 * r), .start = {.value = a1}, .previous = -a2}}};
  }
};

}  // namespace resilin
