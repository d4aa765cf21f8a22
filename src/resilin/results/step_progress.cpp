#include "resilin/results/step_progress.hpp"

#include <algorithm>

#include "resilin/core/text.hpp"
#include "resilin/simulation/initial_acceleration.hpp"
#include "resilin/world/support_phase.hpp"

namespace resilin {
namespace {

/// Whence the step goes and how far, as far as that is known before it has been taken.
std::string way(const World& world, const State& state) {
  if (world.is_dynamic) return "from t = " + format_short(state.time) + " s";
  std::string from = "from load factor " + format_short(state.load);
  if (world.follows_path) return from;
  return from + " by " + format_short(std::min(state.load_increment, 1 - state.load)) + " at most";
}

}  // namespace

std::string describe_progress(const Simulation& simulation, const NewtonReport& so_far, int iterations) {
  const World& world = simulation.world();
  const State& state = simulation.state();
  const std::string step = "step " + std::to_string(state.step + 1) + ", ";
  if (simulation.shows_modes()) return step + "solving for vibration modes";
  const std::string name = step_name_at(world, time_after(state.time, world.time_step));
  return step + (name.empty() ? "" : '"' + one_line(name) + "\", ") + way(world, state) +
         ", Newton iteration " + std::to_string(iterations) + ", residual " +
         format_short(so_far.relative_residual()) + " (tolerance " + format_short(world.newton.tolerance) +
         ")";
}

}  // namespace resilin
