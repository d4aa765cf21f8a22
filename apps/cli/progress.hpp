#pragma once

#include <chrono>

#include "resilin/simulation/simulation.hpp"

namespace resilin::cli {

/// Shows how far a run is: a bar that is redrawn on a terminal, a plain line now and then elsewhere, nothing
/// when quiet.
class Progress {
 public:
  enum class Style { bar, lines, silent };
  static Style style_for_stdout(bool is_quiet);

  Progress(Style style, const Simulation& simulation);

  void iteration(const NewtonReport& so_far);  ///< within a step
  void step(const Simulation& simulation, const StepReport& report);
  void end();  ///< leaves the line of the bar

 private:
  using Clock = std::chrono::steady_clock;

  double share_done(const Simulation& simulation) const;
  std::string state_text(const Simulation& simulation, const StepReport& report) const;
  std::string remaining_text(double share) const;
  void draw();

  Style style_;
  int first_step_;
  double first_time_;
  double first_share_;
  Clock::time_point start_ = Clock::now();
  Clock::time_point next_output_ = Clock::now();
  double share_ = 0;
  std::string text_;
  int iterations_ = 0;
  bool is_drawn_ = false;
};

}  // namespace resilin::cli
