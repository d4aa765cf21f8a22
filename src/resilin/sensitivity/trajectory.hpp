#pragma once

#include <functional>
#include <vector>

#include "resilin/sensitivity/replay.hpp"

namespace resilin {

/// The steps of a run in motion, to be gone through again forwards or backwards, in chunks of about the
/// square root of their number. Kept are the places where stages ended, 24 bytes for a vertex and stage in
/// 3D, and whole states at the starts of the chunks; or, with checkpoints, some of these states alone. Each
/// chunk begins with the bits of the run, whatever is kept.
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
  /// Of the step, from 1; 0: the start. Valid until steps are asked for.
  End end_of(int step);
  /// The step of this number, from 1.
  const StepReplay& step(int number);

 private:
  int chunk_of(int step) const { return (step - 1) / length_; }
  void load(int chunk);
  void make_again(int segment);

  Simulation& simulation_;
  const Integrator& scheme_;
  TakeStep take_step_;
  int num_steps_ = 0;
  int length_;                  ///< of a chunk, whose steps are there at the same time
  int chunks_per_segment_ = 1;  ///< between checkpoints
  bool keeps_places_;
  std::vector<State> checkpoints_;  ///< at the starts of the segments
  State end_;                       ///< of the run
  // Of all chunks, or with checkpoints of the segment that was made again last, the others being empty:
  std::vector<State> states_;                 ///< at the starts
  std::vector<std::vector<VectorX>> places_;  ///< of the stages, by step
  int segment_ = -1;
  int loaded_ = -1;  ///< the chunk of `steps_`
  std::vector<StepReplay> steps_;
  std::vector<Motion> ends_;  ///< of these steps
};

}  // namespace resilin
