#include "share_line.hpp"

#include "terminal.hpp"

namespace resilin::cli {
namespace {

constexpr auto between_bars = std::chrono::milliseconds(100);
constexpr auto between_share_lines = std::chrono::seconds(2);

}  // namespace

void ShareLine::show(double share, const std::function<std::string()>& text) {
  const auto now = Clock::now();
  if (style_ == Progress::Style::silent || now < next_) return;
  if (style_ == Progress::Style::bar) {
    next_ = now + between_bars;
    draw_bar(share, text());
    is_drawn_ = true;
    return;
  }
  next_ = now + between_share_lines;
  print_share(share, text());
}

void ShareLine::end() {
  if (is_drawn_) print_line("");
  is_drawn_ = false;
}

}  // namespace resilin::cli
