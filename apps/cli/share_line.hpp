#pragma once

#include <chrono>
#include <functional>
#include <string>

#include "progress.hpp"

namespace resilin::cli {

/// How far something is that may last: a bar that is redrawn on a terminal, a plain line now and then
/// elsewhere, and neither within the first second.
class ShareLine {
 public:
  explicit ShareLine(Progress::Style style) : style_(style) {}
  ShareLine(const ShareLine&) = delete;
  ShareLine& operator=(const ShareLine&) = delete;
  ~ShareLine() { end(); }

  /// @param text  asked for where it is shown
  void show(double share, const std::function<std::string()>& text);
  void end();  ///< leaves the line of the bar

 private:
  using Clock = std::chrono::steady_clock;
  Progress::Style style_;
  Clock::time_point next_ = Clock::now() + std::chrono::seconds(1);
  bool is_drawn_ = false;
};

}  // namespace resilin::cli
