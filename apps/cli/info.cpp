#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "command.hpp"
#include "resilin/core/cpu.hpp"
#include "resilin/core/parallel.hpp"
#include "resilin/core/text.hpp"
#include "resilin/linear/blas.hpp"
#include "resilin/linear/linear_solver.hpp"
#include "resilin/results/build_info.hpp"
#include "resilin/scene/scene.hpp"
#include "run_together.hpp"
#include "terminal.hpp"

namespace resilin::cli {
namespace {

int print_info(bool as_json) {
  const std::string in_use(name(preferred_instruction_set()));
  const std::vector<std::string> available = names(available_instruction_sets());
  const std::string blas = blas_kernel_name();
  const std::vector<std::string> solvers = linear_solver_names();
  if (as_json) {
    const nlohmann::ordered_json json = {{"version", version()},
                                         {"compiler", compiler()},
                                         {"instruction_set", in_use},
                                         {"instruction_sets", available},
                                         {"compiled_instruction_sets", names(compiled_instruction_sets())},
                                         {"blas_kernel", blas},
                                         {"solvers", solvers},
                                         {"several_processes", distribution_text()},
                                         {"threads", num_threads()}};
    print_line(json.dump(1));
    return done;
  }
  print_text(format_table({{"version", std::string(version())},
                           {"compiler", compiler()},
                           {"elements, iterative solvers", in_use + " (of " + join(available) + ")"},
                           {"direct solvers, BLAS", blas},
                           {"linear solvers", join(solvers)},
                           {"one scene on several MPI processes", distribution_text()},
                           {"threads", std::to_string(num_threads())}}));
  return done;
}

}  // namespace

void add_info(CommandLine& line, Action& action) {
  struct Options {
    bool json = false;
    bool scene_reference = false;
    bool schema = false;
    bool man_page = false;
  };
  auto options = std::make_shared<Options>();
  const Command command =
      line.command("info", "Version, instruction set in use, BLAS kernel, solvers, threads");
  command.flag("--json", options->json, "Print JSON");
  command.flag("--scene-reference", options->scene_reference, "Print the page docs/scene.md");
  command.flag("--schema", options->schema, "Print a JSON schema of the scene file, for editors");
  command.flag("--man-page", options->man_page, "Print the man page resilin.1");
  command.footer("Example:\n  resilin info --json");
  command.on_chosen([&line, options, &action] {
    action = [&line, options] {
      if (options->man_page) {
        print_text(man_page(line.text()));
        return static_cast<int>(done);
      }
      if (!options->scene_reference && !options->schema) return print_info(options->json);
      print_text(options->schema ? scene_schema() : scene_reference());
      return static_cast<int>(done);
    };
  });
}

}  // namespace resilin::cli
