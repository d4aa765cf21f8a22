#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "resilin/core/parallel.hpp"
#include "resilin/simulation/simulation.hpp"
#include "resilin/world/state.hpp"

namespace resilin::testing {

/// Everything that a checkpoint holds of the end of a run, or of where it does not converge, is the same for
/// 1, 2, 3, 4 and 8 threads.
inline void expect_same_bits_for_any_number_of_threads(const Description& scene) {
  const int before = num_threads();
  std::string expected;
  for (const int threads : {1, 2, 3, 4, 8}) {
    set_num_threads(threads);
    Simulation simulation(scene);
    while (!simulation.is_finished() && simulation.step().status == StepReport::Status::converged) {
    }
    const std::string end = serialize(simulation.state());
    if (threads == 1) expected = end;
    EXPECT_TRUE(end == expected) << threads << " threads";
  }
  set_num_threads(before);
}

/// A run ends with the same bits for any number of threads, and when it is broken off after some steps and
/// gone on with.
inline void expect_same_bits_however_it_is_run(const Description& scene, int steps_before_the_break) {
  std::vector<VectorX> ends;
  const auto run_to_the_end = [&](Simulation& simulation) {
    while (!simulation.is_finished()) simulation.step();
    ends.push_back(simulation.state().positions);
  };
  const int before = num_threads();
  for (const int threads : {1, 2, 3, 4, 8}) {
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
  for (const VectorX& end : ends) EXPECT_EQ(ends[0], end);
}

}  // namespace resilin::testing
