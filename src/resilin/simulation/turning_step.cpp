#include "resilin/simulation/turning_step.hpp"

#include <algorithm>
#include <cmath>

namespace resilin {

double turn_of_step(const World& world, const State& state, double time_step) {
  const Conditions begin{.time = state.time}, end{.time = state.time + time_step};
  double turn = largest_turn(world, begin, end);
  if (state.step > 0) return turn;
  for (const Support& support : world.supports) {
    if (support.rotate)
      turn = std::max(turn, std::abs(support.rotate->degrees * support.time_function.factor(end.time, 1)));
  }
  return turn;
}

bool turns_evenly(const World& world, const State& state, double length, int num_parts) {
  if (num_parts == 1) return true;
  double turn = turn_of_step(world, state, length);
  for (int part = 1; part < num_parts; ++part) {
    const double begin = state.time + part * length;
    turn = std::max(turn, largest_turn(world, {.time = begin}, {.time = begin + length}));
  }
  return turn <= largest_turn_of_step * (1 + 1e-9);
}

World with_even_turns(const World& world, const State& state, double time_step) {
  World even = world;
  const double end = state.time + time_step;
  for (Support& support : even.supports) {
    if (!support.rotate) continue;
    const TimeFunction& f = support.time_function;
    const double before = state.step > 0 ? f.factor(state.time, 1) : 0;
    support.time_function = {TimeFunction::Table{{state.time, end}, {before, f.factor(end, 1)}}};
  }
  return even;
}

}  // namespace resilin
