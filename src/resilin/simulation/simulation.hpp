#pragma once

#include <optional>
#include <string>

#include "resilin/simulation/frame.hpp"
#include "resilin/simulation/load_control.hpp"
#include "resilin/simulation/most_strained.hpp"
#include "resilin/simulation/step.hpp"
#include "resilin/simulation/time_stepping.hpp"
#include "resilin/simulation/vibration.hpp"
#include "resilin/world/state.hpp"
#include "resilin/world/world.hpp"

namespace resilin {

/// Times of all steps so far [s].
struct Timing {
  double assembly = 0;  ///< gradients excluded
  double solve = 0;
  double steps = 0;  ///< everything inside `step`
};

/// A running simulation: a world, a state and data kept between steps.
///
///   Simulation simulation(description);
///   while (!simulation.is_finished()) simulation.step();
class Simulation {
 public:
  /// Throws InputError.
  explicit Simulation(Description description) : Simulation(World(std::move(description))) {}
  /// A world may have got energies of the caller's own.
  /// @param analyses  of matrices, which simulations of one mesh may share; changes no result
  explicit Simulation(World world, std::shared_ptr<AnalysisCache> analyses = nullptr);

  const World& world() const { return world_; }
  const State& state() const { return state_; }
  const Frame& frame() const { return frame_; }  ///< report of the present state
  const Timing& timing() const { return timing_; }
  /// Linear solver with the factors of the last step, for solves with a similar matrix. Changes no later
  /// step.
  Newton& newton() { return newton_; }
  std::string_view solver_name() const { return newton_.solver_name(); }
  /// Releases the memory of the linear solver; a further step allocates it again.
  void release_solver() { newton_.release_solver(); }

  /// The modes of vibration, once the first of them has been stepped to.
  const std::vector<VibrationMode>& modes() const { return modes_; }

  /// One time step, one load step as large as converges, or one mode of vibration. `observer` is called after
  /// every Newton iteration.
  StepReport step(const NewtonObserver& observer = {});

  /// Whether the end time, the full load or the last mode is reached.
  bool is_finished() const;

  /// The next step shows a mode of vibration: the equilibrium that they are about has been found.
  bool shows_modes() const;

  /// About how many steps are needed in all, for progress: exact in motion with equal steps, else a guess.
  int expected_steps() const;

  /// From 0 to 1, for progress.
  double share_done() const;

  /// Failed steps since the start, including those of `resume_from`.
  const FailedSteps& failed_steps() const { return failed_steps_; }

  /// Since the start, what `resume_from` was told of included; in statics only the least volume.
  const MostStrained& most_strained() const { return most_strained_; }

  /// Restarts from a saved state. `failed` are its steps that had not converged, `most_strained` its most
  /// strained state. Throws InputError naming `place` if the state does not fit this world; the caller checks
  /// that the scene is the same.
  void resume_from(const State& state, const std::string& place, const FailedSteps& failed = {},
                   const MostStrained& most_strained = {});

 private:
  StepReport step_to_next_mode(const NewtonObserver& observer);
  void measure(const VectorX* step_gradient);
  /// Releases and activates supports that a step of the scene begins with.
  /// @return  why the run cannot go on, in words; empty: it can
  std::string switch_supports_now();
  void note_failure(const std::string& reason);

  World world_;
  std::optional<TimeStepper> time_stepper_;  ///< dynamics
  std::optional<LoadControl> load_control_;  ///< statics
  Newton newton_;
  std::vector<VibrationMode> modes_;  ///< vibration modes, once they are found
  State state_;
  Frame frame_;
  Timing timing_;
  FailedSteps failed_steps_;
  MostStrained most_strained_;
};

}  // namespace resilin
