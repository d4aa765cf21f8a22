#pragma once

#include <utility>
#include <vector>

#include "resilin/integrator/integrator.hpp"

/// The order of what a step in time computes, whoever solves its stages, and the same transposed.
namespace resilin {

Motion zero_motion(Eigen::Index size);
/// A history of nothing but zeros, for changes of one or slopes by one.
History zero_history(Eigen::Index size);

/// The stages of one step, one after another: a run searches for their ends, a replay knows these, and
/// changes of a motion follow the same equations, which are linear.
class StageSequence {
 public:
  /// @param scheme  to outlive this
  StageSequence(const Integrator& scheme, History start, double time_step)
      : scheme_(&scheme), start_(std::move(start)), seen_(start_), time_step_(time_step) {}

  /// The next stage.
  Stage begin() const {
    return scheme_->begin_stage(static_cast<int>(solutions_.size()), seen_, solutions_, time_step_);
  }
  /// Ends it.
  /// @param found     its motion
  /// @param impulses  accelerations by what acts at the end of the stage; they are taken out of the motion,
  ///                  and velocities of what is known jump by them; empty: none [m/s^2]
  /// @param where     nonzero where an impulse acts; empty: where `impulses` are
  void end(const Stage& stage, Motion found, const VectorX& impulses = {}, const VectorX& where = {});

  /// Where the step starts, or the last stage has ended [m].
  const VectorX& last_positions() const {
    return solutions_.empty() ? start_.now.positions : solutions_.back().positions;
  }
  const History& start() const { return start_; }
  const std::vector<Motion>& solutions() const { return solutions_; }

  /// The motion at the end of the step, once all stages have ended. Asked for once.
  Motion finish() { return scheme_->finish(start_, std::move(solutions_), time_step_); }
  /// The start of the next step.
  /// @param end      from `finish`, with what is prescribed there
  /// @param slowing  what was added to its velocities besides; empty: nothing [m/s]
  History after(Motion end, const VectorX& slowing = {}) const;

 private:
  const Integrator* scheme_;
  History start_;
  History seen_;  ///< the start without the impulses in the stages
  double time_step_;
  std::vector<Motion> solutions_;
  VectorX jump_;   ///< jump of velocities in the last stage; empty: none [m/s]
  VectorX where_;  ///< nonzero where it acts
};

/// StageSequence transposed: leads slopes by the start of the next step back to those by the start of the
/// step. Stages come in the opposite order, and each ends before it begins.
class TransposedSequence {
 public:
  /// @param by_next             slopes by what StageSequence::after gave, `now` without what is prescribed
  /// @param where               as StageSequence::end had it in the last stage; empty: no impulse there
  /// @param previous_time_step  that of the step before [s]
  TransposedSequence(const Integrator& scheme, const History& by_next, const VectorX& where, double time_step,
                     double previous_time_step);

  /// Slopes by what StageSequence::end was given.
  struct End {
    VectorX by_x;         ///< by the unknown of the stage
    Stage by_stage;       ///< by its base positions and velocities; its shape has none yet
    VectorX by_impulses;  ///< empty where there are none
  };
  End end(const Stage& stage, const VectorX& where);
  /// Slopes by what StageSequence::begin gave.
  void begin(const Stage& by_stage);

  /// Slopes by the start, so far by the end of the step alone.
  History& by_start() { return by_start_; }
  /// The same by all stages, too.
  History finish() &&;

 private:
  const Integrator& scheme_;
  double time_step_;
  History by_start_, by_seen_;        ///< as StageSequence has them
  VectorX by_jump_;                   ///< by that of the last stage, from the start of the next step
  std::vector<Motion> by_solutions_;  ///< slopes by the motions of stages
  std::size_t stage_;                 ///< stages left
};

}  // namespace resilin
