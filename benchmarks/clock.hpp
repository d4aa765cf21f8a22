#pragma once

#include <time.h>

#include <algorithm>
#include <vector>

namespace resilin::bench {

inline double seconds_of(clockid_t clock) {
  timespec now{};
  clock_gettime(clock, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// Processor time of all threads [s]: on a shared machine the wall clock also measures the neighbours.
inline double cpu_seconds() { return seconds_of(CLOCK_PROCESS_CPUTIME_ID); }
inline double wall_seconds() { return seconds_of(CLOCK_MONOTONIC); }

/// Median time of so many calls of `action` [s].
template <class Action>
double median_wall_seconds(int num_calls, const Action& action) {
  std::vector<double> times;
  for (int i = 0; i < num_calls; ++i) {
    const double start = wall_seconds();
    action();
    times.push_back(wall_seconds() - start);
  }
  std::ranges::nth_element(times, times.begin() + num_calls / 2);
  return times[static_cast<std::size_t>(num_calls / 2)];
}

}  // namespace resilin::bench
