#pragma once

#include "resilin/integrator/integrator.hpp"

namespace resilin {

/// The implicit midpoint rule: forces are those at the middle x_m of the straight way of the step,
///
///   x_m = x_n + dt/2 v_m,   v_m = v_n + dt/2 a_m,   x = 2 x_m - x_n,   v = 2 v_m - v_n
///
/// Second order, symplectic: keeps linear and angular momentum exactly, and energy near its value for long
/// times. The accelerations that it leaves are a_m. Source: Hairer, Lubich & Wanner 2006, sec. VI.4.
class Midpoint final : public Integrator {
 public:
  std::string_view name() const override { return "midpoint"; }
  int order() const override { return 2; }

  StepCoefficients coefficients(double) const override {
    return {.stages = {{.duration = 0.5, .time_fraction = 0.5}}, .end_start = -1, .end_stage = 2};
  }

  /// dt^3/12 a', its slope from the accelerations in the middles of this step and the one before; where that
  /// is not known, from those at the start. What places differ from the motion by a_m was done by contact.
  VectorX local_error(const History& start, const Motion& end, double dt) const override {
    const VectorX by_contact =
        end.positions - start.now.positions - dt * start.now.velocities - 0.5 * dt * dt * end.accelerations;
    return by_contact + dt * dt * dt / 12 * (end.accelerations - start.now.accelerations) /
                            (0.5 * (dt + start.previous_time_step));
  }
};

}  // namespace resilin
