#pragma once

#include <utility>

#include "resilin/core/types.hpp"

namespace resilin {

/// Positions, velocities and accelerations at one instant, dim numbers per node.
struct Motion {
  VectorX positions;      ///< [m]
  VectorX velocities;     ///< [m/s]
  VectorX accelerations;  ///< [m/s^2]
};

/// One minimisation of an implicit step, or of a static one: min_x sum of energies, the inertia 1/(2 s) |x -
/// x~|^2_M among them (docs/theory/integrators.md). Velocities and accelerations follow from its unknown x:
///
///   v = (x - x_0) / c,   a = (v - v_0) / c,   hence   x~ = x_0 + c v_0,   s = c^2
///
/// In statics nothing moves and c = 0; x_0 is then the equilibrium before.
///
/// Contact forces are taken where the stage ends (x, or 2 x - x_0 where x is a mean), and their impulse acts
/// there as a whole: their energies count `contact_weight` times.
struct Stage {
  VectorX base_positions;     ///< x_0: where a node would be that had stopped [m]
  VectorX base_velocities{};  ///< v_0: the velocity of a node without forces [m/s]
  double duration = 0;        ///< c [s]
  double time_fraction = 1;   ///< time fraction of the step, where loads and moving supports are taken
  bool is_mean = false;       ///< x is the mean of the start and the end of the step
  double contact_weight = 1;  ///< times which energies of contact count
  VectorX shape{};            ///< about the x that is sought, known before: where damping is formed [m]
  double load_time = 0;  ///< statics: what the load increment stands for, in which bodies come from x_0 [s]
  double elapsed = 0;    ///< from the start of the step to the instant of x: internal variables follow it [s]

  bool is_static() const { return duration == 0; }
  VectorX target() const { return base_positions + duration * base_velocities; }
  double scale() const { return duration * duration; }
  VectorX velocities(const VectorX& x) const { return (x - base_positions) / duration; }
  /// Position at the stage's end as a function of x: derivative and value.
  double end_slope() const { return is_mean ? 2 : 1; }
  /// From the end of the stage before, or the start of the step, to its own [s].
  double length() const {
    return is_static() ? load_time : contact_weight * end_slope() * end_slope() * duration;
  }
  /// When the end is, after the time of x [s].
  double time_to_end() const { return is_mean ? duration : 0; }
  /// How often the force of contact counts in the balance of forces: (I.1) has it so that it acts as long as
  /// the stage lasts.
  double count_of_impulse() const { return contact_weight * end_slope(); }
  /// Jump of the velocity at the end, by these accelerations [m/s].
  VectorX jump_by(const VectorX& accelerations) const { return end_slope() * duration * accelerations; }
  /// From the start of a step of this length to the stage's end [s].
  double time_from_start(double time_step) const { return time_fraction * time_step + time_to_end(); }
  /// Where the stage would end if bodies had no velocity there; in statics x_0. How far from it the stage
  /// ends is the velocity there times the time of slip.
  VectorX still_end() const {
    return is_mean ? VectorX(base_positions + duration * base_velocities) : base_positions;
  }
  /// [s]
  double time_of_slip() const { return is_static() ? load_time : duration; }
  Motion motion(VectorX x) const {
    VectorX v = velocities(x);
    VectorX a = (v - base_velocities) / duration;
    return {.positions = std::move(x), .velocities = std::move(v), .accelerations = std::move(a)};
  }
};

/// A stage of a static step from the equilibrium `x`. Without a time that it takes nothing slips in it.
inline Stage static_stage(const VectorX& x, double load_time = 0) {
  return {.base_positions = x, .shape = x, .load_time = load_time, .elapsed = load_time};
}

}  // namespace resilin
