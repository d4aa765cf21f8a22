#pragma once

#include <optional>

#include "resilin/optimize/path_follower.hpp"
#include "resilin/simulation/step.hpp"
#include "resilin/world/state.hpp"

namespace resilin {

/// Quasi-static analysis: adaptive load increments, or arc length along the equilibrium path. Theory:
/// docs/theory/statics.md.
///
/// Holds what is worth keeping between steps, none of which changes a result.
class LoadControl {
 public:
  explicit LoadControl(const World& world);

  /// Prepares the data that the first step needs.
  void prepare(const World& world, State& state) const;

  /// One step from `state`, as large as converges. Moves the state there; leaves it alone when the report
  /// says anything but converged (but for the size of the next step, which keeps what was learnt).
  StepReport step(const World& world, Newton& newton, State& state, const NewtonObserver& observer);

  /// The full load is reached, or the number of steps along a path.
  static bool is_finished(const World& world, const State& state);
  /// A guess of the number of all steps.
  static int expected_steps(const World& world, const State& state);

 private:
  StepReport step_in_load(const World& world, Newton& newton, State& state, const NewtonObserver& observer);
  StepReport step_along_path(const World& world, Newton& newton, State& state,
                             const NewtonObserver& observer);
  /// Why the run ends without a first step along the path; empty when it can begin.
  std::string begin_path(const World& world, Newton& newton, State& state, StepReport& report,
                         const NewtonObserver& observer);
  /// The first element inversion of a linear solution; warns if that is within the load.
  static void find_inversion(const World& world, const State& state, StepReport& report);
  void count_unstable_modes(const World& world, const Newton& newton, const State& state, StepReport& report);

  std::optional<PathFollower> follower_;
  std::optional<ExactStiffness> stiffness_;
  std::optional<Index> last_count_;  ///< last count of unstable modes: a warning comes when it changes
  bool has_warned_of_memory_ = false;
};

}  // namespace resilin
