#pragma once

#include <functional>
#include <string>

namespace CLI {
class App;
}

/// The subcommands of `resilin`, one file each.
namespace resilin::cli {

enum ExitCode { done = 0, wrong_input = 1, not_converged = 2, internal_error = 3 };

/// What is left to do once the command line is read; gives the exit code.
using Action = std::function<int()>;

/// Each adds its subcommand; when it is the one on the command line, `action` is set.
void add_run(CLI::App& app, Action& action);
void add_check(CLI::App& app, Action& action);
void add_mesh(CLI::App& app, Action& action);
void add_view(CLI::App& app, Action& action);
void add_picture(CLI::App& app, Action& action);
void add_materials(CLI::App& app, Action& action);
void add_bench(CLI::App& app, Action& action);
void add_info(CLI::App& app, Action& action);

}  // namespace resilin::cli
