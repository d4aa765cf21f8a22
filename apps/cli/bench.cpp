#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "benchmarks.hpp"
#include "command.hpp"
#include "resilin/core/error.hpp"
#include "resilin/core/parallel.hpp"
#include "resilin/core/text.hpp"
#include "terminal.hpp"

namespace resilin::cli {
namespace {

struct BenchCommand {
  std::string name;
  BenchOptions options;
  int threads = 0;
  bool json = false;
};

const Benchmark& find(const std::string& name) {
  std::vector<std::string> names;
  for (const Benchmark& benchmark : benchmarks()) {
    if (benchmark.name == name) return benchmark;
    names.push_back(benchmark.name);
  }
  const std::string nearest = nearest_word(name, names);
  throw InputError("bench", "one of " + join(names), '"' + name + '"',
                   nearest.empty() ? "" : "did you mean \"" + nearest + "\"?");
}

void list() {
  std::vector<std::vector<std::string>> rows;
  for (const Benchmark& benchmark : benchmarks()) rows.push_back({benchmark.name, benchmark.text});
  print_text(format_table(rows));
}

int bench(const BenchCommand& command) {
  if (command.name.empty()) {
    list();
    return done;
  }
  if (command.threads > 0) set_num_threads(command.threads);
  const std::vector<Measurement> measurements = find(command.name).run(command.options);
  if (command.json) {
    nlohmann::ordered_json json = {{"benchmark", command.name}, {"threads", num_threads()}};
    for (const auto& [name, value] : measurements) json[name] = value;
    print_line(json.dump(1));
    return done;
  }
  std::vector<std::vector<std::string>> rows;
  for (const auto& [name, value] : measurements) rows.push_back({name, fmt::format("{:.6g}", value)});
  print_text(format_table(rows));
  return done;
}

}  // namespace

void add_bench(CLI::App& app, Action& action) {
  auto options = std::make_shared<BenchCommand>();
  CLI::App* command = app.add_subcommand("bench", "List the built-in benchmarks, or run one");
  command->add_option("name", options->name, "Name of a benchmark");
  command->add_option("--n", options->options.n, "Size of the problem, where it has one")
      ->check(CLI::Range(1, 1000));
  command->add_flag("--dynamic", options->options.dynamic,
                    "Motion instead of statics, where a benchmark has both");
  command->add_option("--element", options->options.element,
                      "Element of the kernels and the bar: P1, P2 or P2P0");
  command->add_option("--threads", options->threads, "Number of threads; default all cores")
      ->check(CLI::Range(1, 1024));
  command->add_flag("--json", options->json, "Print JSON");
  command->footer("Example:\n  resilin bench cube --threads 1 --json");
  command->callback([options, &action] { action = [options] { return bench(*options); }; });
}

}  // namespace resilin::cli
