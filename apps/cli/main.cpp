#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <new>
#include <string>
#include <vector>

#include "command.hpp"
#include "resilin/core/cpu.hpp"
#include "resilin/core/error.hpp"
#include "resilin/core/text.hpp"
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

/// A first word that is no command; empty when there is none.
std::string unknown_command(const CLI::App& app, int argc, char** argv) {
  if (argc < 2 || argv[1][0] == '-') return {};
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; })) {
    if (command->get_name() == argv[1]) return {};
    names.push_back(command->get_name());
  }
  const std::string nearest = nearest_word(argv[1], names);
  return InputError("command", "one of " + join(names), '"' + std::string(argv[1]) + '"',
                    nearest.empty() ? "see resilin --help" : "did you mean \"" + nearest + "\"?")
      .what();
}

std::string help_hint(const CLI::App& app) {
  const auto chosen = app.get_subcommands();
  return "; see resilin " + (chosen.empty() ? "" : chosen.front()->get_name() + " ") + "--help";
}

int main(int argc, char** argv) {
  CLI::App app("Resilin simulates hyperelastic solids with finite elements.", "resilin");
  app.set_version_flag("--version", std::string(version()));
  app.require_subcommand(1);
  app.footer(
      "Example:\n  resilin run examples/spot.toml --out out/spot\n\nEach command tells more: resilin run "
      "--help");
  Action action;
  add_run(app, action);
  add_check(app, action);
  add_view(app, action);
  add_picture(app, action);
  add_mesh(app, action);
  add_materials(app, action);
  add_bench(app, action);
  add_info(app, action);
  if (const std::string message = unknown_command(app, argc, argv); !message.empty()) {
    return fail(wrong_input, message);
  }
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& success) {  // --help, --version
    return app.exit(success);
  } catch (const CLI::ParseError& error) {
    return fail(wrong_input, error.what() + help_hint(app));
  }
  return run_action(action);
}

}  // namespace
}  // namespace resilin::cli

int main(int argc, char** argv) { return resilin::cli::main(argc, argv); }
