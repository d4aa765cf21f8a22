#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace resilin::cli {

/// Output and exit code of another program.
struct Subprocess {
  enum class End { exited, killed_by_signal, out_of_time, interrupted, not_started };
  End end = End::not_started;
  int exit_code = 0;
  std::string log_end;  ///< the last line of what it wrote that is not empty
};

/// The program of this name on PATH; empty when there is none.
std::optional<std::filesystem::path> find_program(const std::string& name);

/// Runs a program in a folder, without a shell, until it ends, the time is over or Ctrl-C; then it and what
/// it started are killed. What it writes goes to `log.txt` in the folder; it has nothing to read.
Subprocess run_subprocess(const std::filesystem::path& program, const std::vector<std::string>& arguments,
                          const std::filesystem::path& folder, double seconds);

}  // namespace resilin::cli
