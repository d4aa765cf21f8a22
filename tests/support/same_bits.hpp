#pragma once

#include <gtest/gtest.h>

#include <vector>

#include "resilin/core/parallel.hpp"
#include "resilin/simulation/simulation.hpp"

namespace resilin::testing {

/// A run ends with the same bits for any number of threads, and when it is broken off after some steps and
/// gone on with.
inline void expect_same_bits_however_it_is_run(const Description& scene, int steps_before_the_break) {
  std::vector<VectorX> ends;
  const auto run_to_the_end = [&](Simulation& simulation) {
    while (!simulation.is_finished()) simulation.step();
    ends.push_back(simulation.state().positions);
  };
  const int before = num_threads();
  for (const int threads : {1, 2}) {
    set_num_threads(threads);
    Simulation whole(scene);
    run_to_the_end(whole);
  }
  set_num_threads(before);
  Simulation first(scene);
  for (int step = 0; step < steps_before_the_break; ++step) first.step();
  Simulation second(scene);
  second.resume_from(first.state(), "here");
  run_to_the_end(second);
  EXPECT_EQ(ends[0], ends[1]);
  EXPECT_EQ(ends[0], ends[2]);
}

}  // namespace resilin::testing
