#include "resilin/sensitivity/trajectory.hpp"

#include <algorithm>
#include <cmath>

#include "resilin/simulation/step_attempt.hpp"

namespace resilin {

Trajectory::Trajectory(Simulation& simulation, const Integrator& scheme, int checkpoints, TakeStep take_step)
    : simulation_(simulation),
      scheme_(scheme),
      take_step_(std::move(take_step)),
      keeps_places_(checkpoints == 0),
      begin_{simulation.state().positions, simulation.state().velocities, {}} {
  const int expected = std::max(1, simulation.expected_steps());
  length_ = static_cast<int>(std::ceil(std::sqrt(expected)));
  const int num_chunks = (expected + length_ - 1) / length_;
  if (!keeps_places_) chunks_per_segment_ = (num_chunks + checkpoints - 1) / checkpoints;
  for (; !simulation.is_finished(); ++num_steps_) {
    if (keeps_places_) {
      make_room(num_steps_ + 1);
      keep_step(num_steps_);
    } else {
      if (num_steps_ % (length_ * chunks_per_segment_) == 0) checkpoints_.push_back(simulation.state());
      take_step_();
    }
  }
  end_ = {simulation.state().positions, simulation.state().velocities, {}};
}

void Trajectory::make_room(int num_steps) {
  places_.resize(static_cast<std::size_t>(num_steps));
  chunk_starts_.resize(static_cast<std::size_t>((num_steps + length_ - 1) / length_));
}

void Trajectory::leave_out_unneeded(History& history) const {
  if (!scheme_.needs_accelerations()) history.now.accelerations = {};
  const std::vector<StageCoefficients> stages = scheme_.coefficients(1).stages;
  if (std::ranges::any_of(stages, [](const StageCoefficients& stage) { return stage.previous != 0; })) return;
  history.previous_positions = history.previous_velocities = {};
}

/// Takes a step of the simulation, from 0, and keeps where its stages end, and of the first one of a chunk
/// what it starts from.
void Trajectory::keep_step(int step) {
  const State& state = simulation_.state();
  const History before = history_of(state);
  const auto number = static_cast<std::size_t>(step);
  if (step % length_ == 0) {
    Start& start = chunk_starts_[static_cast<std::size_t>(step / length_)];
    start = {.time = state.time, .history = before};
    leave_out_unneeded(start.history);
    if (step > 0 && !places_[number - 1].empty() && places_[number - 1].back() == before.now.positions)
      start.history.now.positions = {};
  }
  std::vector<VectorX> earlier = take_step_();
  places_[number] = places_of_stages(scheme_, before, state, std::move(earlier));
}

/// To the same bits.
void Trajectory::make_again(int segment) {
  if (segment_ == segment) return;
  places_.clear();
  chunk_starts_.clear();
  make_room(num_steps_);
  simulation_.resume_from(checkpoints_[static_cast<std::size_t>(segment)], "checkpoint");
  const int first = segment * chunks_per_segment_ * length_;
  for (int step = first; step < std::min(first + chunks_per_segment_ * length_, num_steps_); ++step)
    keep_step(step);
  segment_ = segment;
}

void Trajectory::load(int chunk) {
  if (loaded_ == chunk) return;
  if (!keeps_places_) make_again(chunk / chunks_per_segment_);
  replayed_ = 0;
  starts_.clear();
  Start start = chunk_starts_[static_cast<std::size_t>(chunk)];
  const int first = chunk * length_;
  if (start.history.now.positions.size() == 0)
    start.history.now.positions = places_[static_cast<std::size_t>(first - 1)].back();
  for (int step = first; step < std::min(first + length_, num_steps_); ++step) {
    if (step > first) start.time = step * simulation_.world().time_step;
    starts_.push_back(start);
    const StepReplay made = replay(step);
    for (const StageReplay& stage : made.stages) starts_.back().by_impulses.push_back(stage.by_impulses);
    start.history = history_after(simulation_.world(), made);
    leave_out_unneeded(start.history);
  }
  starts_.push_back(std::move(start));
  loaded_ = chunk;
}

/// A step of the chunk whose starts are there, from 0.
StepReplay Trajectory::replay(int step) const {
  const World& world = simulation_.world();
  const Start& start = starts_[static_cast<std::size_t>(step % length_)];
  return replay_step(world, scheme_, start.history, start.time, world.time_step,
                     places_[static_cast<std::size_t>(step)], start.by_impulses);
}

Trajectory::End Trajectory::end_of(int step) {
  if (step == 0) return {begin_.positions, begin_.velocities};
  if (step == num_steps_) return {end_.positions, end_.velocities};
  load(chunk_of(step));
  const Motion& end = starts_[static_cast<std::size_t>((step - 1) % length_ + 1)].history.now;
  return {end.positions, end.velocities};
}

const StepReplay& Trajectory::step(int number) {
  load(chunk_of(number));
  if (replayed_ != number) step_.emplace(replay(number - 1));
  replayed_ = number;
  return *step_;
}

}  // namespace resilin
