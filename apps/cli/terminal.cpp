#include "terminal.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace resilin::cli {

void print_warnings(const std::vector<std::string>& warnings) {
  for (const std::string& warning : warnings) fmt::print(stderr, "warning: {}\n", one_line(warning));
}

void print_line(std::string_view text) { fmt::print("{}\n", text); }

void print_text(std::string_view text) { fmt::print("{}", text); }

std::string format_seconds(double seconds) {
  if (seconds < 59.5) return fmt::format("{:.3g} s", seconds);
  const long whole = std::lround(seconds);
  if (whole < 3600) return fmt::format("{} min {:02} s", whole / 60, whole % 60);
  return fmt::format("{} h {:02} min", whole / 3600, whole % 3600 / 60);
}

}  // namespace resilin::cli
