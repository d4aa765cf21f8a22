#pragma once

#include <functional>
#include <string>

#include "resilin/results/summary.hpp"
#include "resilin/simulation/simulation.hpp"

namespace resilin {

/// Callbacks of a run; each may be empty.
struct RunHooks {
  std::function<bool()> is_stopped = {};  ///< asked before every step and after every Newton iteration
  std::function<void(const NewtonReport& so_far)> after_iteration = {};
  std::function<void(const StepReport& report)> after_step = {};
  std::function<std::string()> stopper = {};  ///< who has stopped it, in words; empty: the user
  int max_steps = 0;                          ///< 0: no limit
};

/// Steps until the end, the limit, a stop or, in statics, a load that has no equilibrium. Steps that failed
/// before a restart count in the verdict. The outcome warns of what is odd about the state that was reached
/// (simulation/oddities.hpp).
RunOutcome run_to_end(Simulation& simulation, const RunHooks& hooks);

/// "t = 0.5 s (step 50)" or "load factor 1 (step 3)".
std::string reached(const Simulation& simulation);

}  // namespace resilin
