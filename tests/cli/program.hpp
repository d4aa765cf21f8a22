#pragma once

#include <sys/types.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace resilin::testing {

/// Where `resilin` is that belongs to these tests.
std::string program_path();

struct ProgramResult {
  int exit_code = 0;  ///< 128 + signal when it was killed
  std::string out, err;
};

/// Runs `resilin ARGUMENTS` in a folder, with variables such as "LC_ALL=C" in its environment.
ProgramResult run_program(const std::filesystem::path& folder, const std::vector<std::string>& arguments,
                          const std::vector<std::string>& environment = {});

/// Runs a script of `sh` in a folder; "$RESILIN" in it is the program.
ProgramResult run_shell(const std::filesystem::path& folder, const std::string& script);

/// `resilin ARGUMENTS` while it runs; killed at the end unless it has been waited for.
class RunningProgram {
 public:
  RunningProgram(const std::filesystem::path& folder, const std::vector<std::string>& arguments);
  ~RunningProgram();
  RunningProgram(const RunningProgram&) = delete;
  RunningProgram& operator=(const RunningProgram&) = delete;

  /// Output so far, as soon as that matches a regular expression or the program has ended.
  std::string wait_for(const std::string& pattern);
  bool is_running() const;
  void kill(int signal);
  pid_t process() const { return process_; }
  ProgramResult finish();

 private:
  std::filesystem::path folder_;
  pid_t process_;
};

/// Starts it and sends a signal as soon as `file` exists in the folder `out`; once more without that folder
/// where the program was at its end before a busy machine came to look.
ProgramResult run_program_until(const std::filesystem::path& folder,
                                const std::vector<std::string>& arguments, const std::string& out,
                                const std::string& file, int signal);

nlohmann::json read_json(const std::filesystem::path& path);
std::string read_text_file(const std::filesystem::path& path);

/// A small scene that is right: a static box held at one side, with a probe.
extern const std::string box_scene;

}  // namespace resilin::testing
