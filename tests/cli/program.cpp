#include "program.hpp"

#include <fcntl.h>
#include <signal.h>
#include <stdlib.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <fstream>
#include <iterator>
#include <regex>
#include <thread>
#include <utility>

namespace resilin::testing {
namespace {

/// Starts a program with its output in files of the folder.
pid_t start(const std::filesystem::path& folder, std::vector<std::string> words,
            const std::vector<std::string>& environment) {
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  std::filesystem::remove(folder / "stdout.txt");  // results of a run before
  const pid_t process = fork();
  if (process != 0) return process;
  const auto redirect = [&](const char* name, int descriptor) {
    const int file = open((folder / name).c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0666);
    dup2(file, descriptor);
  };
  redirect("stdout.txt", STDOUT_FILENO);
  redirect("stderr.txt", STDERR_FILENO);
  for (const std::string& variable : environment) {
    const std::size_t equals = variable.find('=');
    setenv(variable.substr(0, equals).c_str(), variable.substr(equals + 1).c_str(), 1);
  }
  for (const int number : {SIGHUP, SIGINT, SIGQUIT, SIGTERM}) signal(number, SIG_DFL);  // nohup ignores some
  if (chdir(folder.c_str()) != 0) _exit(126);
  alarm(300);  // a hang is a failure
  execv(pointers[0], pointers.data());
  _exit(127);
}

std::vector<std::string> resilin(const std::vector<std::string>& arguments) {
  std::vector<std::string> words = {program_path()};
  words.insert(words.end(), arguments.begin(), arguments.end());
  return words;
}

ProgramResult finish(pid_t process, const std::filesystem::path& folder) {
  int status = 0;
  waitpid(process, &status, 0);
  ProgramResult result;
  result.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  result.out = read_text_file(folder / "stdout.txt");
  result.err = read_text_file(folder / "stderr.txt");
  return result;
}

}  // namespace

std::string program_path() { return RESILIN_PROGRAM; }

const std::string box_scene = R"(title = "A box"
[simulation]
kind = "static"
gravity = [0, 0, -9.81]
[[body]]
name = "box"
element = "P1"
mesh = { box = { size = [2, 1, 1], cells = [4, 2, 2] } }
material = { law = "neo_hookean", youngs_modulus = 1e6, poissons_ratio = 0.3, density = 1000 }
[[fix]]
name = "wall"
where = { group = "x_min" }
[[probe]]
name = "tip"
at = [2, 0.5, 0.5]
)";

ProgramResult run_program(const std::filesystem::path& folder, const std::vector<std::string>& arguments,
                          const std::vector<std::string>& environment) {
  return finish(start(folder, resilin(arguments), environment), folder);
}

ProgramResult run_shell(const std::filesystem::path& folder, const std::string& script) {
  return finish(start(folder, {"/bin/sh", "-c", script}, {"RESILIN=" + program_path()}), folder);
}

RunningProgram::RunningProgram(const std::filesystem::path& folder, const std::vector<std::string>& arguments)
    : folder_(folder), process_(start(folder, resilin(arguments), {})) {}

RunningProgram::~RunningProgram() {
  if (process_ < 0) return;
  kill(SIGKILL);
  finish();
}

bool RunningProgram::is_running() const {
  siginfo_t ended{};
  return waitid(P_PID, static_cast<id_t>(process_), &ended, WEXITED | WNOHANG | WNOWAIT) == 0 &&
         ended.si_pid == 0;
}

std::string RunningProgram::wait_for(const std::string& pattern) {
  const std::regex wanted(pattern);
  for (;;) {
    const bool was_running = is_running();
    std::string out = read_text_file(folder_ / "stdout.txt");
    if (!was_running || std::regex_search(out, wanted)) return out;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
}

void RunningProgram::kill(int signal) { ::kill(process_, signal); }

ProgramResult RunningProgram::finish() { return testing::finish(std::exchange(process_, -1), folder_); }

ProgramResult run_program_until(const std::filesystem::path& folder,
                                const std::vector<std::string>& arguments, const std::string& out,
                                const std::string& file, int signal) {
  for (;;) {
    RunningProgram program(folder, arguments);
    while (!std::filesystem::exists(folder / out / file) && program.is_running()) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    program.kill(signal);
    ProgramResult result = program.finish();
    const bool was_late = result.exit_code == 0 && std::filesystem::exists(folder / out / file);
    if (!was_late) return result;
    std::filesystem::remove_all(folder / out);
  }
}

std::string read_text_file(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

nlohmann::json read_json(const std::filesystem::path& path) {
  return nlohmann::json::parse(read_text_file(path));
}

}  // namespace resilin::testing
