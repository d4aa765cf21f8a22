#include "sweep_progress.hpp"

#include <fmt/format.h>

#include <optional>

#include "terminal.hpp"

namespace resilin::cli {
namespace {

constexpr auto between_sweep_lines = std::chrono::seconds(5);

double share_of(const SweepCount& count) {
  return count.scenes == 0
             ? 1
             : static_cast<double>(count.done + count.failed) / static_cast<double>(count.scenes);
}

std::string left_text(const SweepProgress& progress) {
  if (progress.count.left() == 0) return "";
  const std::optional<double> seconds = progress.seconds_left();
  return seconds ? ", " + format_seconds(*seconds) + " left" : ", " + format_seconds(progress.seconds);
}

}  // namespace

std::string count_text(const SweepCount& count) {
  const std::string failed = count.failed == 0 ? "" : fmt::format(", {} failed", count.failed);
  return fmt::format("{} of {} done{}", count.done, count.scenes, failed);
}

void SweepProgressLine::show(const SweepProgress& progress) {
  if (style_ == Progress::Style::silent) return;
  if (!has_told_failure_ && !progress.first_failure.empty()) {
    end();
    print_warnings({progress.first_failure + "; its reason is in the table, as those of others are"});
    has_told_failure_ = true;
  }
  const std::string text = count_text(progress.count) + left_text(progress);
  if (style_ == Progress::Style::bar) {
    draw_bar(share_of(progress.count), text);
    is_drawn_ = true;
    return;
  }
  const auto now = Clock::now();
  if (now < next_line_) return;
  const bool is_first = next_line_ == Clock::time_point{};
  next_line_ = now + between_sweep_lines;
  if (is_first && progress.run == 0) return;  // nothing has been said that is new
  print_share(share_of(progress.count), text);
}

void SweepProgressLine::end() {
  if (is_drawn_) print_line("");
  is_drawn_ = false;
}

}  // namespace resilin::cli
