#include <unistd.h>

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "command.hpp"
#include "interrupt.hpp"
#include "resilin/core/error.hpp"

namespace resilin::cli {
namespace {

constexpr const char* program_name = "resilin-bench";

/// The program that holds the benchmarks, beside this one.
std::filesystem::path bench_program() {
  return std::filesystem::read_symlink("/proc/self/exe").parent_path() / program_name;
}

/// Becomes that program; returns only when there is none.
int bench(std::vector<std::string> arguments) {
  const std::string program = bench_program().string();
  std::vector<char*> values = {const_cast<char*>(program_name)};
  for (std::string& argument : arguments) values.push_back(argument.data());
  values.push_back(nullptr);
  die_of_failed_writes();
  execv(program.c_str(), values.data());
  report_failed_writes();
  throw InputError("bench", "the program " + std::string(program_name) + " beside resilin", "none",
                   "build it: ./run bench, or cmake --build FOLDER --target resilin_bench");
}

}  // namespace

void add_bench(CommandLine& line, Action& action) {
  const Command command = line.command("bench", "List the built-in benchmarks, or run one");
  command.takes_everything();  // the benchmarks' own program answers
  command.on_chosen(
      [command, &action] { action = [arguments = command.remaining()] { return bench(arguments); }; });
}

}  // namespace resilin::cli
