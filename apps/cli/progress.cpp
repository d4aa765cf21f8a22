#include "progress.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>

#include "terminal.hpp"

namespace resilin::cli {
namespace {

constexpr auto between_draws = std::chrono::milliseconds(100);
constexpr auto between_lines = std::chrono::seconds(2);

}  // namespace

Progress::Style Progress::style_for_stdout(bool is_quiet) {
  if (is_quiet) return Style::silent;
  return isatty(STDOUT_FILENO) == 1 ? Style::bar : Style::lines;
}

Progress::Progress(Style style, const Simulation& simulation)
    : style_(style),
      first_step_(simulation.state().step),
      first_time_(simulation.state().time),
      first_share_(share_done(simulation)) {}

double Progress::share_done(const Simulation& simulation) const { return simulation.share_done(); }

std::string Progress::remaining_text(double share) const {
  const double elapsed = std::chrono::duration<double>(Clock::now() - start_).count();
  const double gained = share - first_share_;
  if (gained <= 0 || share >= 1) return "";
  return ", " + format_seconds(elapsed / gained * (1 - share)) + " left";
}

std::string Progress::state_text(const Simulation& simulation, const StepReport& report) const {
  const State& state = simulation.state();
  std::string text = fmt::format("step {}", state.step);
  if (simulation.frame().mode) {
    return text + fmt::format(", mode {}, {:.6g} Hz", state.mode, simulation.frame().mode->frequency);
  }
  if (simulation.world().is_dynamic) {
    text += fmt::format("/{}, t = {:.4g} s", simulation.expected_steps(), state.time);
  } else {
    text += fmt::format(", load {:.4g}", state.load);
  }
  text += fmt::format(", {} Newton, residual {:.1e}", report.newton.iterations,
                      report.newton.relative_residual());
  if (simulation.world().is_dynamic) {
    const double elapsed = std::chrono::duration<double>(Clock::now() - start_).count();
    text += fmt::format(", {:.2g}x real time", (state.time - first_time_) / std::max(elapsed, 1e-9));
  }
  return text;
}

void Progress::iteration(const NewtonReport& so_far) {
  if (style_ != Style::bar || Clock::now() < next_output_) return;
  iterations_ = so_far.iterations;
  draw();
}

void Progress::step(const Simulation& simulation, const StepReport& report) {
  if (style_ == Style::silent) return;
  share_ = share_done(simulation);
  const bool is_last = simulation.is_finished();
  if (Clock::now() < next_output_ && !is_last) return;
  text_ = state_text(simulation, report) + remaining_text(share_);
  iterations_ = 0;
  if (style_ == Style::bar) return draw();
  next_output_ = Clock::now() + between_lines;
  print_line(fmt::format("{:3.0f} %  {}", 100 * share_, text_));
  flush_output();
}

void Progress::draw() {
  constexpr int width = 24;
  const int filled = std::clamp(static_cast<int>(share_ * width), 0, width);
  const std::string inside = iterations_ > 0 ? fmt::format(" (iteration {})", iterations_) : "";
  print_text(fmt::format("\r\x1b[K[{:#<{}}{:.<{}}] {}{}", "", filled, "", width - filled, text_, inside));
  flush_output();
  is_drawn_ = true;
  next_output_ = Clock::now() + between_draws;
}

void Progress::end() {
  if (is_drawn_) print_line("");
  is_drawn_ = false;
}

}  // namespace resilin::cli
