#pragma once

#include <memory>

#include "resilin/integrator/backward_euler.hpp"
#include "resilin/simulation/step.hpp"
#include "resilin/world/state.hpp"

namespace resilin {

/// Steps through time by the integrator of a world (docs/theory/integrators.md).
class TimeStepper {
 public:
  /// Throws InputError for an unknown integrator.
  explicit TimeStepper(const World& world);

  /// Completes a state that a run begins with: the motion of its fixed unknowns, and the accelerations where
  /// the integrator needs them and the state has none.
  void prepare(const World& world, State& state) const;

  /// One step from `state`, which is moved; left alone when interrupted. `gradient` becomes dE/dx of the step
  /// with its inertia, from which reactions follow.
  StepReport step(const World& world, Newton& newton, State& state, VectorX& gradient,
                  const NewtonObserver& observer) const;

 private:
  struct Attempt;
  Attempt attempt(const World& world, Newton& newton, const State& state, double time_step,
                  const Integrator& integrator, const NewtonObserver& observer) const;
  /// The same by the world's integrator; by backward Euler where its end would be outside the domain, would
  /// hold more energy than there was, or was not found while bodies touch.
  Attempt safe_attempt(const World& world, Newton& newton, const State& state, double time_step,
                       const NewtonObserver& observer) const;
  enum class WhenLost { go_on, stop };  ///< after a part that has no solution
  /// Steps of equal length from `start` to `end`, which is left alone when they are interrupted or stop: they
  /// lead supports around their turns and take in parts what has no solution as a whole.
  StepReport step_in_parts(const World& world, Newton& newton, const State& start, State& end,
                           VectorX& gradient, double time_step, int num_parts, WhenLost when_lost,
                           const NewtonObserver& observer) const;
  /// Tries steps until the estimate of the error is below the tolerance.
  StepReport adaptive_step(const World& world, const AdaptiveSteps& options, Newton& newton, State& state,
                           VectorX& gradient, const NewtonObserver& observer) const;
  /// About how far the step, the latest that `newton` was asked for, misplaces a vertex [m].
  double step_error(const World& world, Newton& newton, const State& state, const Attempt& found,
                    double time_step) const;
  /// State at the start of a step; where loads or prescribed motions begin or end, with the accelerations of
  /// what follows.
  History start_of_step(const World& world, const State& state, double time_step) const;

  std::unique_ptr<Integrator> integrator_;
  BackwardEuler safest_;
  double strain_stiffness_;  ///< [J]
};

}  // namespace resilin
