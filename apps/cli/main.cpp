#include <cstdio>
#include <exception>
#include <new>
#include <optional>
#include <string>

#include "command.hpp"
#include "resilin/core/cpu.hpp"
#include "resilin/core/error.hpp"
#include "resilin/linear/blas.hpp"
#include "resilin/results/build_info.hpp"

namespace resilin::cli {
namespace {

int fail(int code, const std::string& message) {
  std::fprintf(stderr, "resilin: %s\n", message.c_str());
  return code;
}

int run_action(const Action& action) {
  try {
    preferred_instruction_set();  // what cannot be had is said before any work is done
    choose_blas_kernel();
    return action();
  } catch (const InputError& error) {
    return fail(wrong_input, error.what());
  } catch (const std::bad_alloc&) {
    return fail(wrong_input, "out of memory: the problem is too large for this machine");
  } catch (const std::exception& error) {
    return fail(internal_error, std::string("internal error: ") + error.what());
  }
}

int main(int argc, char** argv) {
  CommandLine line(
      {.program = "resilin",
       .help = "Resilin simulates hyperelastic solids with finite elements.",
       .version = std::string(version()),
       .footer = "Example:\n  resilin run examples/spot.toml --out out/spot\n\nEach command tells more: "
                 "resilin run --help"});
  Action action;
  add_run(line, action);
  add_check(line, action);
  add_view(line, action);
  add_picture(line, action);
  add_mesh(line, action);
  add_materials(line, action);
  add_bench(line, action);
  add_info(line, action);
  try {
    if (const std::optional<int> code = line.read(argc, argv)) return *code;
  } catch (const CommandLineError& error) {
    return fail(wrong_input, error.what());
  }
  return run_action(action);
}

}  // namespace
}  // namespace resilin::cli

int main(int argc, char** argv) { return resilin::cli::main(argc, argv); }
