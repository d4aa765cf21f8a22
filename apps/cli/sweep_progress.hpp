#pragma once

#include <chrono>

#include "progress.hpp"
#include "resilin/sweep/sweep_run.hpp"

namespace resilin::cli {

/// Shows how far a sweep is, as `Progress` does for a run.
class SweepProgressLine {
 public:
  explicit SweepProgressLine(Progress::Style style) : style_(style) {}

  void show(const SweepProgress& progress);
  void end();  ///< leaves the line of the bar

 private:
  using Clock = std::chrono::steady_clock;

  Progress::Style style_;
  Clock::time_point next_line_{};
  bool is_drawn_ = false;
  bool has_told_failure_ = false;
};

/// "12 of 200 done, 1 failed".
std::string count_text(const SweepCount& count);

}  // namespace resilin::cli
