#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "resilin/core/types.hpp"

namespace resilin {

/// Positions, velocities and accelerations at one instant, dim numbers per node.
struct Motion {
  VectorX positions;      ///< [m]
  VectorX velocities;     ///< [m/s]
  VectorX accelerations;  ///< [m/s^2]
};

/// What a step starts from.
struct History {
  Motion now;
  VectorX previous_positions{};  ///< one step before
  VectorX previous_velocities{};
  double previous_time_step = 0;  ///< of that step [s]; 0: there was none
};

/// One minimisation of an implicit step: min_x 1/(2 s) |x - x~|^2_M + sum of energies (docs/theory/
/// integrators.md). Velocities and accelerations follow from its unknown x:
///
///   v = (x - x_0) / c,   a = (v - v_0) / c,   hence   x~ = x_0 + c v_0,   s = c^2
struct Stage {
  VectorX base_positions;    ///< x_0: where a node would be that had stopped [m]
  VectorX base_velocities;   ///< v_0: the velocity of a node without forces [m/s]
  double duration = 0;       ///< c [s]
  double time_fraction = 1;  ///< of the step, where loads and moving supports are taken
  bool is_mean = false;      ///< x is the mean of the start and the end of the step

  VectorX target() const { return base_positions + duration * base_velocities; }
  double scale() const { return duration * duration; }
  VectorX velocities(const VectorX& x) const { return (x - base_positions) / duration; }
  Motion motion(VectorX x) const {
    VectorX v = velocities(x);
    VectorX a = (v - base_velocities) / duration;
    return {.positions = std::move(x), .velocities = std::move(v), .accelerations = std::move(a)};
  }
};

/// A time stepping scheme as a list of stages.
class Integrator {
 public:
  virtual ~Integrator() = default;
  virtual std::string_view name() const = 0;
  virtual int order() const = 0;
  virtual int num_stages() const { return 1; }
  /// A step starts from accelerations, so that a run begins with M a = -gradient.
  virtual bool needs_accelerations() const { return false; }

  /// The last stage finds the end of the step itself, so that it is inside the energies' domain.
  virtual bool solves_for_end() const { return true; }

  /// The minimisation of stage `stage`. `solutions` holds the motions at the minimisers of the stages before
  /// it.
  virtual Stage begin_stage(int stage, const History& start, const std::vector<Motion>& solutions,
                            double time_step) const = 0;

  /// The motion at the end of the step, from the motions at the minimisers of all stages.
  virtual Motion finish(const History& /*start*/, std::vector<Motion> solutions, double /*time_step*/) const {
    return std::move(solutions.back());
  }

  /// About how far the places at the end of a step are off, given those at its start [m]: the distance to
  ///
  ///   x_n + dt v_n + dt^2 (a_n / 3 + a / 6),
  ///
  /// which is right where accelerations are linear in time. Needs the accelerations at both ends.
  virtual VectorX local_error(const History& start, const Motion& end, double time_step) const {
    const double dt = time_step;
    return end.positions - start.now.positions - dt * start.now.velocities -
           dt * dt * (start.now.accelerations / 3 + end.accelerations / 6);
  }
};

/// An integrator by name; throws InputError for an unknown one, `place` begins its message.
std::unique_ptr<Integrator> make_integrator(std::string_view name, const std::string& place);

/// Names of all integrators, in the order of the catalogue.
std::vector<std::string> integrator_names();

}  // namespace resilin
