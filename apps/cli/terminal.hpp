#pragma once

#include <chrono>
#include <string>
#include <string_view>
#include <vector>

#include "resilin/core/text.hpp"  // format_short

namespace resilin::cli {

/// Runs from its construction on.
class Stopwatch {
 public:
  double seconds() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point start_ = Clock::now();
};

/// "resilin: ..." on stderr, one line.
void print_error(std::string_view text);

/// "warning: ..." on stderr, one line each.
void print_warnings(const std::vector<std::string>& warnings);

/// A line on stdout; text that has its own line ends. What cannot be written is remembered.
void print_line(std::string_view text);
void print_text(std::string_view text);

/// A bar with a text behind it, in place of the one before, in a line that is not ended.
void draw_bar(double share, std::string_view text);

/// The same where no bar can be drawn: a line of its own, " 12 %  TEXT", at once.
void print_share(double share, std::string_view text);

/// Hands stdout over to the system. False once anything could not be written.
bool flush_output();
bool nobody_reads_output();    ///< the reader of a pipe has gone
std::string output_problem();  ///< "standard output: cannot be written: ..."; empty when all is well

std::string format_seconds(double seconds);  ///< "0.52 s", "3 min 20 s", "2 h 05 min"

}  // namespace resilin::cli
