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

  /// @param simulation  kept by reference
  Progress(Style style, const Simulation& simulation);

  void iteration(const NewtonReport& so_far);  ///< within a step: shown once that lasts
  void step(const Simulation& simulation, const StepReport& report);
  void end();  ///< leaves the line of the bar

 private:
  using Clock = std::chrono::steady_clock;

  double share_done(const Simulation& simulation) const;
  std::string state_text(const Simulation& simulation, const StepReport& report) const;
  std::string remaining_text(double share) const;
  void draw(const std::string& text);
  void print_share(const std::string& text);

  Style style_;
  const Simulation* simulation_;
  int first_step_;
  double first_time_;
  double first_share_;
  Clock::time_point start_ = Clock::now();
  Clock::time_point step_start_ = start_;
  Clock::time_point next_output_ = start_;
  Clock::time_point next_line_of_step_ = start_;
  double share_ = 0;
  std::string text_;
  int iterations_ = 0;  ///< iterations of the step that is going on
  bool is_drawn_ = false;
};

}  // namespace resilin::cli
