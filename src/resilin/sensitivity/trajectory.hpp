#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "resilin/sensitivity/replay.hpp"

namespace resilin {

/// The steps of a run in motion, to be gone through again forwards or backwards, in chunks of about the
/// square root of their number. Kept are the places where stages ended, 24 bytes for a vertex and stage in
/// 3D, and what the scheme starts from at the starts of the chunks; or, with checkpoints, whole states at
/// some of these alone. Of one chunk there is besides what each of its steps starts from. Each chunk begins
/// with the bits of the run, whatever is kept.
class Trajectory {
 public:
  /// Takes a step of the simulation; throws when it cannot. @return StepReport::stage_places
  using TakeStep = std::function<std::vector<VectorX>()>;

  /// Runs the simulation to its end.
  /// @param checkpoints  see DerivativeOptions
  Trajectory(Simulation& simulation, const Integrator& scheme, int checkpoints, TakeStep take_step);

  int num_steps() const { return num_steps_; }
  struct End {
    const VectorX &positions, &velocities;
  };
  /// End of the step, from 1; 0: the start. Valid until another end or step is asked for.
  End end_of(int step);
  /// The step of this number, from 1; likewise.
  const StepReplay& step(int number);

 private:
  /// State at the start of a step, as far as the scheme looks at it; positions that are the last place before
  /// are left out at the start of a chunk.
  struct Start {
    double time = 0;
    History history{};
    std::vector<VectorX> by_impulses{};  ///< impulses of the stages of the step
  };
  void leave_out_unneeded(History& history) const;
  void make_room(int num_steps);
  void keep_step(int step);
  int chunk_of(int step) const { return (step - 1) / length_; }
  void load(int chunk);
  void make_again(int segment);
  StepReplay replay(int step) const;

  Simulation& simulation_;
  const Integrator& scheme_;
  TakeStep take_step_;
  int num_steps_ = 0;
  int length_;                  ///< length of a chunk, whose steps are there at the same time
  int chunks_per_segment_ = 1;  ///< between checkpoints
  bool keeps_places_;
  Motion begin_, end_;              ///< begin and end of the run, without accelerations
  std::vector<State> checkpoints_;  ///< at the starts of the segments, where there are such
  // All chunks, or with checkpoints those of the segment that was made again last, the others being empty:
  std::vector<Start> chunk_starts_;
  std::vector<std::vector<VectorX>> places_;  ///< places of the stages, by step
  int segment_ = -1;
  int loaded_ = -1;            ///< the chunk of `starts_`
  std::vector<Start> starts_;  ///< starts of its steps, and of the one after
  int replayed_ = 0;           ///< the number of `step_`; 0: none
  std::optional<StepReplay> step_;
};

}  // namespace resilin
