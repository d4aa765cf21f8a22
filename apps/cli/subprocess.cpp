#include "subprocess.hpp"

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <fstream>
#include <string_view>
#include <thread>

#include "interrupt.hpp"
#include "terminal.hpp"

extern char** environ;

namespace resilin::cli {
namespace {

/// How a program starts: its folder, its output, a group of its own so that all of it can be killed.
class StartOptions {
 public:
  explicit StartOptions(const std::filesystem::path& folder) {
    posix_spawn_file_actions_init(&files_);
    posix_spawn_file_actions_addchdir_np(&files_, folder.c_str());
    posix_spawn_file_actions_addopen(&files_, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_addopen(&files_, STDOUT_FILENO, (folder / "log.txt").c_str(),
                                     O_WRONLY | O_CREAT | O_TRUNC, 0600);
    posix_spawn_file_actions_adddup2(&files_, STDOUT_FILENO, STDERR_FILENO);
    posix_spawnattr_init(&attributes_);
    posix_spawnattr_setflags(&attributes_,
                             POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETSIGMASK);
    sigset_t none;  // catch_interrupts blocks some here
    sigemptyset(&none);
    posix_spawnattr_setsigmask(&attributes_, &none);
    sigset_t ignored_here;  // by report_failed_writes
    sigemptyset(&ignored_here);
    for (const int number : {SIGPIPE, SIGXFSZ}) sigaddset(&ignored_here, number);
    posix_spawnattr_setsigdefault(&attributes_, &ignored_here);
    posix_spawnattr_setpgroup(&attributes_, 0);
  }
  ~StartOptions() {
    posix_spawn_file_actions_destroy(&files_);
    posix_spawnattr_destroy(&attributes_);
  }
  StartOptions(const StartOptions&) = delete;
  StartOptions& operator=(const StartOptions&) = delete;

  const posix_spawn_file_actions_t* files() const { return &files_; }
  const posix_spawnattr_t* attributes() const { return &attributes_; }

 private:
  posix_spawn_file_actions_t files_{};
  posix_spawnattr_t attributes_{};
};

std::string last_line(const std::filesystem::path& log) {
  std::ifstream file(log);
  std::string last;
  for (std::string line; std::getline(file, line);)
    if (line.find_first_not_of(" \t\r") != std::string::npos) last = line;
  for (char& c : last)
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = ' ';
  constexpr std::size_t longest = 300;
  return last.substr(0, longest);
}

}  // namespace

std::optional<std::filesystem::path> find_program(const std::string& name) {
  const char* path = std::getenv("PATH");
  std::string_view rest = path == nullptr ? "" : path;
  while (!rest.empty()) {
    const std::size_t colon = std::min(rest.find(':'), rest.size());
    const std::filesystem::path folder = rest.substr(0, colon);
    rest.remove_prefix(std::min(colon + 1, rest.size()));
    if (!folder.is_absolute()) continue;
    std::error_code ignored;
    std::filesystem::path file = folder / name;
    if (std::filesystem::is_regular_file(file, ignored) && access(file.c_str(), X_OK) == 0) return file;
  }
  return std::nullopt;
}

Subprocess run_subprocess(const std::filesystem::path& program, const std::vector<std::string>& arguments,
                          const std::filesystem::path& folder, double seconds) {
  std::vector<std::string> words = {program.string()};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);

  Subprocess result;
  const StartOptions options(folder);
  pid_t process = 0;
  if (posix_spawn(&process, program.c_str(), options.files(), options.attributes(), pointers.data(),
                  environ) != 0)
    return result;
  const Stopwatch watch;
  int status = 0;
  while (waitpid(process, &status, WNOHANG) == 0) {
    if (is_interrupted() || watch.seconds() > seconds) {
      kill(-process, SIGKILL);
      waitpid(process, &status, 0);
      result.end = is_interrupted() ? Subprocess::End::interrupted : Subprocess::End::out_of_time;
      result.log_end = last_line(folder / "log.txt");
      return result;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  result.end = WIFEXITED(status) ? Subprocess::End::exited : Subprocess::End::killed_by_signal;
  result.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : WTERMSIG(status);
  result.log_end = last_line(folder / "log.txt");
  return result;
}

}  // namespace resilin::cli
