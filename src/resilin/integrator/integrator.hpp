#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "resilin/integrator/stage.hpp"

namespace resilin {

/// Start of a step.
struct History {
  Motion now;
  VectorX previous_positions{};  ///< one step before
  VectorX previous_velocities{};
  double previous_time_step = 0;  ///< previous time step of that step [s]; 0: there was none
};

/// How one motion that is known counts in the start (x_0, v_0) of a stage: x and v times `value`, and v and a
/// times `slope` and the time step.
struct MotionWeight {
  double value = 0;
  double slope = 0;
};

/// A stage of a scheme for steps of length 1:
///
///   x_0 = sum_k value_k x_k + dt slope_k v_k,   v_0 = sum_k value_k v_k + dt slope_k a_k
///
/// over the motion one step before (whose slope never counts), the motion at the start and those that the
/// stages before it have found. The values sum to one.
struct StageCoefficients {
  double duration = 1;       ///< c / dt
  double time_fraction = 1;  ///< where in the step its unknown is
  MotionWeight start = {.value = 1};
  std::vector<MotionWeight> stages{};
  double previous = 0;  ///< value of the motion one step before
};

/// A scheme as numbers: everything that a step computes is a linear combination of motions.
struct StepCoefficients {
  std::vector<StageCoefficients> stages;
  /// The end of the step, x and v, is `end_start` times its start and `end_stage` times its last stage. Its
  /// accelerations are those of the last stage.
  double end_start = 0;
  double end_stage = 1;
};

/// A time stepping scheme.
class Integrator {
 public:
  virtual ~Integrator() = default;
  virtual std::string_view name() const = 0;
  virtual int order() const = 0;

  /// @param ratio  of the length of the step to that of the one before it; 0 where there was none
  virtual StepCoefficients coefficients(double ratio) const = 0;

  /// About how far the places at the end of a step are off, given those at its start [m]: the distance to
  ///
  ///   x_n + dt v_n + dt^2 (a_n / 3 + a / 6),
  ///
  /// which is right where accelerations are linear in time. Needs the accelerations at both ends. Where they
  /// leave contact out, dt^2 (b_n / 3 + b / 6) with those by contact, b, is to be taken off.
  virtual VectorX local_error(const History& start, const Motion& end, double time_step) const;

  int num_stages() const;
  /// A step starts from accelerations, so that a run begins with M a = -gradient.
  bool needs_accelerations() const;
  /// A stage starts from more than the place and the velocity at the start of its step: impulses of contact
  /// are to be kept out of what it starts from.
  bool looks_back() const;

  /// The minimisation of stage `stage`. `solutions` holds the motions at the minimisers of the stages before
  /// it.
  Stage begin_stage(int stage, const History& start, const std::vector<Motion>& solutions,
                    double time_step) const;

  /// The motion at the end of the step, from the motions at the minimisers of all stages.
  Motion finish(const History& start, std::vector<Motion> solutions, double time_step) const;

  // Both are linear in the motions, so that they also lead changes of motions on. Transposed they lead slopes
  // back: from those by what they give (of the stage: its base positions, base velocities and shape) to those
  // by the motions, which are added. `start.previous_time_step` is that of the step.
  void add_slopes_of_stage(int stage, const Stage& slopes, double time_step, History& start,
                           std::vector<Motion>& solutions) const;
  void add_slopes_of_end(const Motion& slopes, double time_step, History& start,
                         std::vector<Motion>& solutions) const;
};

/// An integrator by name; throws InputError for an unknown one, `place` begins its message.
std::unique_ptr<Integrator> make_integrator(std::string_view name, const std::string& place);

/// Names of all integrators, in the order of the catalogue.
std::vector<std::string> integrator_names();

}  // namespace resilin
