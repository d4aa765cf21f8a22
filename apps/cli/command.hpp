#pragma once

#include <functional>

#include "command_line.hpp"

/// The subcommands of `resilin`, one file each.
namespace resilin::cli {

enum ExitCode { done = 0, wrong_input = 1, not_converged = 2, internal_error = 3 };

/// Action that runs after the command line is read; returns the exit code.
using Action = std::function<int()>;

/// Each adds its subcommand; when it is the one on the command line, `action` is set.
void add_run(CommandLine& line, Action& action);
void add_sweep(CommandLine& line, Action& action);
void add_check(CommandLine& line, Action& action);
void add_new(CommandLine& line, Action& action);
void add_mesh(CommandLine& line, Action& action);
void add_view(CommandLine& line, Action& action);
void add_export(CommandLine& line, Action& action);
void add_picture(CommandLine& line, Action& action);
void add_revolve(CommandLine& line, Action& action);
void add_plot(CommandLine& line, Action& action);
void add_gradcheck(CommandLine& line, Action& action);
void add_rest_shape(CommandLine& line, Action& action);
void add_film(CommandLine& line, Action& action);
void add_materials(CommandLine& line, Action& action);
void add_fit(CommandLine& line, Action& action);
void add_bench(CommandLine& line, Action& action);
void add_info(CommandLine& line, Action& action);
void add_doctor(CommandLine& line, Action& action);
void add_completion(CommandLine& line, Action& action);

}  // namespace resilin::cli
