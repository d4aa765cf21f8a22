#include <exception>
#include <new>
#include <optional>
#include <string>

#include "command.hpp"
#include "interrupt.hpp"
#include "resilin/core/cpu.hpp"
#include "resilin/core/error.hpp"
#include "resilin/linear/blas.hpp"
#include "resilin/results/build_info.hpp"
#include "terminal.hpp"

namespace resilin::cli {
namespace {

int fail(int code, const std::string& message) {
  print_error(message);
  return code;
}

int run_action(const Action& action) {
  try {
    preferred_instruction_set();  // what cannot be had is said before any work is done
    choose_blas_kernel();
    return action();
  } catch (const InputError& error) {
    return fail(wrong_input, error.what());
  } catch (const Interrupted&) {
    return fail(not_converged, "stopped by " + interrupter());
  } catch (const std::bad_alloc&) {
    return fail(wrong_input, "out of memory: the problem is too large for this machine");
  } catch (const std::exception& error) {
    return fail(internal_error, std::string("internal error: ") + error.what());
  }
}

int run_command(int argc, char** argv) {
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

int main(int argc, char** argv) {
  report_failed_writes();
  const int code = run_command(argc, argv);
  if (flush_output()) return code;
  return fail(code == done ? wrong_input : code, output_problem());
}

}  // namespace
}  // namespace resilin::cli

int main(int argc, char** argv) { return resilin::cli::main(argc, argv); }
