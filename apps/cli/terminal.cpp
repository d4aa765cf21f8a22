#include "terminal.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdio>

#include "resilin/core/output_file.hpp"

namespace resilin::cli {
namespace {

int output_error = 0;  ///< the first error of stdout, which the stream itself forgets

void note_output(bool is_written) {
  if (!is_written && output_error == 0) output_error = errno == 0 ? EIO : errno;
}

void print(std::FILE* stream, std::string_view text) { std::fwrite(text.data(), 1, text.size(), stream); }

}  // namespace

void print_error(std::string_view text) { print(stderr, fmt::format("resilin: {}\n", text)); }

void draw_bar(double share, std::string_view text) {
  constexpr int width = 24;
  const int filled = std::clamp(static_cast<int>(share * width), 0, width);
  print_text(fmt::format("\r\x1b[K[{:#<{}}{:.<{}}] {}", "", filled, "", width - filled, text));
  flush_output();
}

void print_share(double share, std::string_view text) {
  print_line(fmt::format("{:3.0f} %  {}", 100 * share, text));
  flush_output();
}

void print_warnings(const std::vector<std::string>& warnings) {
  for (const std::string& warning : warnings) print(stderr, "warning: " + one_line(warning) + "\n");
}

void print_line(std::string_view text) { print_text(std::string(text) + "\n"); }

void print_text(std::string_view text) {
  errno = 0;
  note_output(std::fwrite(text.data(), 1, text.size(), stdout) == text.size());
}

bool flush_output() {
  errno = 0;
  note_output(std::fflush(stdout) == 0 && std::ferror(stdout) == 0);
  return output_error == 0;
}

bool nobody_reads_output() { return output_error == EPIPE; }

std::string output_problem() {
  if (output_error == 0) return "";
  return "standard output: cannot be written: " + reason_of_failed_write(output_error);
}

std::string format_seconds(double seconds) {
  if (seconds < 59.5) return fmt::format("{:.3g} s", seconds);
  const long whole = std::lround(seconds);
  if (whole < 3600) return fmt::format("{} min {:02} s", whole / 60, whole % 60);
  return fmt::format("{} h {:02} min", whole / 3600, whole % 3600 / 60);
}

}  // namespace resilin::cli
