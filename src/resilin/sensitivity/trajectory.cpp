#include "resilin/sensitivity/trajectory.hpp"

#include <algorithm>
#include <cmath>

#include "resilin/simulation/step_attempt.hpp"

namespace resilin {

Trajectory::Trajectory(Simulation& simulation, const Integrator& scheme, int checkpoints, TakeStep take_step)
    : simulation_(simulation),
      scheme_(scheme),
      take_step_(std::move(take_step)),
      keeps_places_(checkpoints == 0) {
  const int expected = std::max(1, simulation.expected_steps());
  length_ = static_cast<int>(std::ceil(std::sqrt(expected)));
  const int num_chunks = (expected + length_ - 1) / length_;
  if (!keeps_places_) chunks_per_segment_ = (num_chunks + checkpoints - 1) / checkpoints;
  while (!simulation.is_finished()) {
    const State& state = simulation.state();
    if (num_steps_ % (length_ * chunks_per_segment_) == 0) checkpoints_.push_back(state);
    if (keeps_places_ && num_steps_ % length_ == 0) states_.push_back(state);
    const History before = keeps_places_ ? history_of(state) : History{};
    std::vector<VectorX> earlier = take_step_();
    ++num_steps_;
    if (keeps_places_) places_.push_back(places_of_stages(scheme_, before, state, std::move(earlier)));
  }
  end_ = simulation.state();
}

/// To the same bits.
void Trajectory::make_again(int segment) {
  if (segment_ == segment) return;
  states_.assign(static_cast<std::size_t>((num_steps_ + length_ - 1) / length_), State{});
  places_.assign(static_cast<std::size_t>(num_steps_), {});
  simulation_.resume_from(checkpoints_[static_cast<std::size_t>(segment)], "checkpoint");
  const int first = segment * chunks_per_segment_ * length_;
  for (int step = first; step < std::min(first + chunks_per_segment_ * length_, num_steps_); ++step) {
    const State& state = simulation_.state();
    if (step % length_ == 0) states_[static_cast<std::size_t>(step / length_)] = state;
    const History before = history_of(state);
    std::vector<VectorX> earlier = take_step_();
    places_[static_cast<std::size_t>(step)] = places_of_stages(scheme_, before, state, std::move(earlier));
  }
  segment_ = segment;
}

void Trajectory::load(int chunk) {
  if (loaded_ == chunk) return;
  if (!keeps_places_) make_again(chunk / chunks_per_segment_);
  const World& world = simulation_.world();
  const State& state = states_[static_cast<std::size_t>(chunk)];
  History start = history_of(state);
  steps_.clear();
  ends_.clear();
  for (int step = chunk * length_; step < std::min((chunk + 1) * length_, num_steps_); ++step) {
    const double time = steps_.empty() ? state.time : step * world.time_step;
    steps_.push_back(
        replay_step(world, scheme_, start, time, world.time_step, places_[static_cast<std::size_t>(step)]));
    start = history_after(world, scheme_, steps_.back());
    ends_.push_back(start.now);
  }
  loaded_ = chunk;
}

Trajectory::End Trajectory::end_of(int step) {
  if (step == 0 && !checkpoints_.empty())
    return {checkpoints_.front().positions, checkpoints_.front().velocities};
  if (step == 0 || step == num_steps_) return {end_.positions, end_.velocities};
  load(chunk_of(step));
  const Motion& end = ends_[static_cast<std::size_t>((step - 1) % length_)];
  return {end.positions, end.velocities};
}

const StepReplay& Trajectory::step(int number) {
  load(chunk_of(number));
  return steps_[static_cast<std::size_t>((number - 1) % length_)];
}

}  // namespace resilin
