#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <exception>
#include <new>
#include <optional>
#include <string>
#include <system_error>

#include "command.hpp"
#include "interrupt.hpp"
#include "resilin/core/cpu.hpp"
#include "resilin/core/error.hpp"
#include "resilin/core/memory.hpp"
#include "resilin/core/parallel.hpp"
#include "resilin/linear/blas.hpp"
#include "resilin/results/build_info.hpp"
#include "terminal.hpp"
#ifdef RESILIN_HAS_PETSC
#include "resilin/petsc/gamg_solver.hpp"
#endif

namespace resilin::cli {
namespace {

int fail(int code, const std::string& message) {
  print_error(message);
  return code;
}

/// A thread that cannot be had is, as a rule, a stack for which there is no room.
bool is_out_of_memory(const std::system_error& error) {
  return error.code() == std::errc::resource_unavailable_try_again ||
         error.code() == std::errc::not_enough_memory;
}

/// For memory that runs out where no exception may pass, such as in a thread of a library. Takes none itself.
[[noreturn]] void end_at_once() {
  try {
    if (const std::exception_ptr error = std::current_exception()) std::rethrow_exception(error);
  } catch (const std::bad_alloc&) {
    std::fputs("resilin: out of memory: take fewer cells, fewer threads, or raise the limit\n", stderr);
    _exit(wrong_input);
  } catch (...) {
    std::abort();
  }
  std::abort();
}

int run_action(const Action& action) {
  try {
    preferred_instruction_set();  // reports a missing instruction set before any work is done
    num_threads();
    choose_blas_kernel();
    return action();
  } catch (const InputError& error) {
    return fail(wrong_input, error.what());
  } catch (const Interrupted&) {
    return fail(not_converged, "stopped by " + interrupter());
  } catch (const std::bad_alloc& error) {
    return fail(wrong_input, out_of_memory_text(error));
  } catch (const std::system_error& error) {
    if (is_out_of_memory(error)) return fail(wrong_input, out_of_memory_text(std::bad_alloc()));
    return fail(internal_error, std::string("internal error: ") + error.what());
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
  add_sweep(line, action);
  add_check(line, action);
  add_view(line, action);
  add_export(line, action);
  add_picture(line, action);
  add_film(line, action);
  add_plot(line, action);
  add_revolve(line, action);
  add_new(line, action);
  add_mesh(line, action);
  add_gradcheck(line, action);
  add_rest_shape(line, action);
  add_materials(line, action);
  add_fit(line, action);
  add_bench(line, action);
  add_info(line, action);
  add_doctor(line, action);
  add_completion(line, action);
  try {
    if (const std::optional<int> code = line.read(argc, argv)) return *code;
  } catch (const CommandLineError& error) {
    return fail(wrong_input, error.what());
  }
  return run_action(action);
}

int main(int argc, char** argv) {
  std::set_terminate(end_at_once);
  report_failed_writes();
#ifdef RESILIN_HAS_PETSC
  register_petsc_solver();
#endif
  const int code = run_command(argc, argv);
  if (flush_output()) return code;
  return fail(code == done ? wrong_input : code, output_problem());
}

}  // namespace
}  // namespace resilin::cli

int main(int argc, char** argv) { return resilin::cli::main(argc, argv); }
