#pragma once

#include <vector>

#include "resilin/integrator/integrator.hpp"
#include "resilin/simulation/simulation.hpp"

/// Steps of a run, made again from the places where they ended: everything else follows from these.
namespace resilin {

struct StageReplay {
  Stage stage;
  Conditions conditions;
  Motion motion;
};

struct StepReplay {
  double time = 0;  ///< at its start [s]
  double time_step = 0;
  History start{};
  /// Loads or prescribed motions are not smooth at the start: its accelerations are those that follow.
  bool renews_accelerations = false;
  std::vector<StageReplay> stages{};
};

/// Where the stages of a step ended, from its start and its end. Of schemes with one stage, or with a first
/// one that counts in the second by its value alone.
std::vector<VectorX> places_of_stages(const Integrator& scheme, const History& start, double time_step,
                                      const State& end);

StepReplay replay_step(const World& world, const Integrator& scheme, const History& start, double time,
                       double time_step, std::vector<VectorX> places);

/// What the next step starts from.
History history_after(const World& world, const Integrator& scheme, const StepReplay& step);

}  // namespace resilin
