#pragma once

#include <vector>

#include "resilin/integrator/stage_sequence.hpp"
#include "resilin/simulation/potential.hpp"
#include "resilin/simulation/simulation.hpp"

/// Steps of a run, made again from the places where they ended: everything else follows from these.
namespace resilin {

/// A stage of a time step as it was solved.
struct StageReplay {
  Stage stage;
  Conditions conditions;
  Motion motion;  ///< its accelerations as they go on, without those by impulses where the scheme keeps these
                  ///< out
  /// By contact and friction, where the scheme takes them apart; empty: they do nothing there [m/s^2].
  VectorX by_impulses{};
};

/// A step of a run as it was taken.
struct StepReplay {
  double time;  ///< at its start [s]
  double time_step;
  /// Loads or prescribed motions are not smooth at the start: its accelerations are those that follow.
  bool renews_accelerations;
  StageSequence sequence;  ///< all its stages have ended
  std::vector<StageReplay> stages{};

  const History& start() const { return sequence.start(); }
  Conditions conditions_at_start() const { return {.time = time}; }
  Conditions conditions_at_end() const { return {.time = time + time_step}; }
};

/// Forces of a stage at its end.
Potential potential_of(const World& world, const StageReplay& stage);

/// Final positions of the stages of a step.
/// @param earlier  those before the last one, which follows from the step's end (StepReport::stage_places)
std::vector<VectorX> places_of_stages(const Integrator& scheme, const History& start, const State& end,
                                      std::vector<VectorX> earlier);

/// @param by_impulses  StageReplay::by_impulses of the stages, where they are known; empty: not yet
StepReplay replay_step(const World& world, const Integrator& scheme, const History& start, double time,
                       double time_step, std::vector<VectorX> places, std::vector<VectorX> by_impulses = {});

/// Start of the next step.
History history_after(const World& world, const StepReplay& step);

}  // namespace resilin
