#include "resilin/integrator/stage_sequence.hpp"

#include <utility>

namespace resilin {
namespace {

/// How a motion that is known looks once an impulse has changed velocities by `jump`: as though bodies had
/// come at even speed on the way that they now go on. Differences of motions then hold what is smooth alone.
/// Where the impulse has acted, its place is that of even speed; nodes without an impulse keep theirs.
/// @param where    nonzero where it has acted
/// @param elapsed  from the motion to `end` [s]
/// @param end      motion at the end of the stage of the impulse
void follow_jump(const VectorX& jump, const VectorX& where, double elapsed, const Motion& end,
                 VectorX& positions, VectorX& velocities) {
  positions = (where.array() != 0).select(end.positions - elapsed * end.velocities, positions);
  velocities += jump;
}

/// Transposes follow_jump by its positions and its end: slopes by the known place where an impulse acts are
/// slopes by that end.
void transpose_jump(const VectorX& where, double elapsed, VectorX& by_positions, Motion& by_end) {
  if (where.size() == 0) return;
  const VectorX by_place = (where.array() != 0).select(by_positions, VectorX::Zero(by_positions.size()));
  by_positions -= by_place;
  by_end.positions += by_place;
  by_end.velocities -= elapsed * by_place;
}

}  // namespace

Motion zero_motion(Eigen::Index size) {
  const VectorX zero = VectorX::Zero(size);
  return {zero, zero, zero};
}

History zero_history(Eigen::Index size) {
  const VectorX zero = VectorX::Zero(size);
  return {.now = zero_motion(size), .previous_positions = zero, .previous_velocities = zero};
}

void StageSequence::end(const Stage& stage, Motion found, const VectorX& impulses, const VectorX& where) {
  jump_.resize(0);
  if (impulses.size() > 0) {
    found.accelerations -= impulses;
    jump_ = stage.jump_by(impulses);
    where_ = where.size() > 0 ? where : jump_;
    follow_jump(jump_, where_, stage.time_from_start(time_step_), found, seen_.now.positions,
                seen_.now.velocities);
  }
  solutions_.push_back(std::move(found));
}

History StageSequence::after(Motion end, const VectorX& slowing) const {
  History next{.now = std::move(end),
               .previous_positions = start_.now.positions,
               .previous_velocities = start_.now.velocities,
               .previous_time_step = time_step_};
  if (slowing.size() > 0) {
    next.previous_positions -= time_step_ * slowing;
    next.previous_velocities += slowing;
  }
  if (jump_.size() > 0)
    follow_jump(jump_, where_, time_step_, next.now, next.previous_positions, next.previous_velocities);
  return next;
}

TransposedSequence::TransposedSequence(const Integrator& scheme, const History& by_next, const VectorX& where,
                                       double time_step, double previous_time_step)
    : scheme_(scheme),
      time_step_(time_step),
      by_start_(zero_history(by_next.now.positions.size())),
      by_jump_(by_next.previous_velocities),
      stage_(static_cast<std::size_t>(scheme.num_stages())) {
  by_start_.previous_time_step = previous_time_step;
  by_seen_ = by_start_;
  by_solutions_.assign(stage_, by_start_.now);
  VectorX by_previous = by_next.previous_positions;
  Motion by_end = by_next.now;
  transpose_jump(where, time_step, by_previous, by_end);
  by_start_.now.positions += by_previous;
  by_start_.now.velocities += by_next.previous_velocities;
  scheme_.add_slopes_of_end(by_end, time_step, by_start_, by_solutions_);
}

TransposedSequence::End TransposedSequence::end(const Stage& stage, const VectorX& where) {
  const bool is_last = stage_ == by_solutions_.size();
  Motion& by_motion = by_solutions_[--stage_];
  const VectorX zero = VectorX::Zero(by_motion.positions.size());
  End by{.by_x = {},
         .by_stage = {.base_positions = zero,
                      .base_velocities = zero,
                      .duration = stage.duration,
                      .shape = zero},
         .by_impulses = {}};
  transpose_jump(where, stage.time_from_start(time_step_), by_seen_.now.positions, by_motion);
  if (where.size() > 0) {
    VectorX by_jump = by_seen_.now.velocities;
    if (is_last) by_jump += by_jump_;
    by.by_impulses = stage.jump_by(by_jump) - by_motion.accelerations;
  }
  // v = (x - x_0) / c, a = (v - v_0) / c
  const double c = stage.duration;
  const VectorX by_velocity = by_motion.velocities + by_motion.accelerations / c;
  by.by_stage.base_velocities -= by_motion.accelerations / c;
  by.by_stage.base_positions -= by_velocity / c;
  by.by_x = by_motion.positions + by_velocity / c;
  return by;
}

void TransposedSequence::begin(const Stage& by_stage) {
  scheme_.add_slopes_of_stage(static_cast<int>(stage_), by_stage, time_step_, by_seen_, by_solutions_);
}

History TransposedSequence::finish() && {
  by_start_.now.positions += by_seen_.now.positions;
  by_start_.now.velocities += by_seen_.now.velocities;
  by_start_.now.accelerations += by_seen_.now.accelerations;
  by_start_.previous_positions += by_seen_.previous_positions;
  by_start_.previous_velocities += by_seen_.previous_velocities;
  by_start_.previous_time_step = 0;
  return std::move(by_start_);
}

}  // namespace resilin
