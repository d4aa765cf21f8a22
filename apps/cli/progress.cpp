#include "progress.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>

#include "resilin/core/text.hpp"
#include "resilin/results/step_progress.hpp"
#include "terminal.hpp"

namespace resilin::cli {
namespace {

constexpr auto between_draws = std::chrono::milliseconds(100);
constexpr auto between_lines = std::chrono::seconds(2);
/// A step that lasts longer than this is told of while it goes on; where lines are printed, one for each of
/// the longer time without any.
constexpr auto long_step = std::chrono::seconds(1);
constexpr auto between_lines_of_a_step = std::chrono::seconds(10);

}  // namespace

Progress::Style Progress::style_for_stdout(bool is_quiet) {
  if (is_quiet) return Style::silent;
  return isatty(STDOUT_FILENO) == 1 ? Style::bar : Style::lines;
}

Progress::Progress(Style style, const Simulation& simulation)
    : style_(style),
      simulation_(&simulation),
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
  if (const auto& mode = simulation.frame().mode)
    return text + fmt::format(", mode {}, {:.6g} Hz", state.mode, mode->frequency);
  if (simulation.world().is_dynamic) {
    text += fmt::format("/{}, t = {:.4g} s", simulation.expected_steps(), state.time);
  } else {
    text += fmt::format(", load {:.4g}", state.load);
  }
  if (const std::string& name = simulation.frame().step_name; !name.empty())
    text += fmt::format(", \"{}\"", one_line(name));
  text += fmt::format(", {} Newton, residual {:.1e}", report.newton.iterations,
                      report.newton.relative_residual());
  if (simulation.world().is_dynamic) {
    const double elapsed = std::chrono::duration<double>(Clock::now() - start_).count();
    text += fmt::format(", {:.2g}x real time", (state.time - first_time_) / std::max(elapsed, 1e-9));
  }
  return text;
}

void Progress::iteration(const NewtonReport& so_far) {
  if (style_ == Style::silent) return;
  ++iterations_;
  const auto now = Clock::now();
  const bool is_long = now - step_start_ >= long_step;
  if (style_ == Style::bar && now >= next_output_) {
    draw(is_long ? describe_progress(*simulation_, so_far, iterations_)
                 : fmt::format("{} (iteration {})", text_, iterations_));
  } else if (style_ == Style::lines && is_long && now >= next_line_of_step_) {
    print_share(describe_progress(*simulation_, so_far, iterations_));
  }
}

void Progress::step(const Simulation& simulation, const StepReport& report) {
  if (style_ == Style::silent) return;
  iterations_ = 0;
  step_start_ = Clock::now();
  share_ = share_done(simulation);
  const bool is_last = simulation.is_finished();
  if (step_start_ < next_output_ && !is_last) return;
  text_ = state_text(simulation, report) + remaining_text(share_);
  if (style_ == Style::bar) return draw(text_);
  next_output_ = step_start_ + between_lines;
  print_share(text_);
}

void Progress::draw(const std::string& text) {
  draw_bar(share_, text);
  is_drawn_ = true;
  next_output_ = Clock::now() + between_draws;
}

void Progress::print_share(const std::string& text) {
  cli::print_share(share_, text);
  next_line_of_step_ = Clock::now() + between_lines_of_a_step;
}

void Progress::end() {
  if (is_drawn_) print_line("");
  is_drawn_ = false;
}

}  // namespace resilin::cli
