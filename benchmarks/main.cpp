#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <new>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "benchmarks.hpp"
#include "resilin/core/cpu.hpp"
#include "resilin/core/error.hpp"
#include "resilin/core/memory.hpp"
#include "resilin/core/parallel.hpp"
#include "resilin/core/text.hpp"
#include "resilin/core/thread_count.hpp"
#include "resilin/linear/blas.hpp"

/// The program that `resilin bench` starts.
namespace resilin::bench {
namespace {

struct Command {
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
  refuse_word("bench", name, names);
}

void print(const std::vector<std::vector<std::string>>& rows) { fmt::print("{}", format_table(rows)); }

void list() {
  std::vector<std::vector<std::string>> rows;
  for (const Benchmark& benchmark : benchmarks()) rows.push_back({benchmark.name, benchmark.text});
  print(rows);
}

void run(const Command& command) {
  if (command.name.empty()) return list();
  const Benchmark& benchmark = find(command.name);
  if (command.threads > 0) set_num_threads(command.threads);
  const std::vector<Measurement> measurements = benchmark.run(command.options);
  if (command.json) {
    nlohmann::ordered_json json = {{"benchmark", command.name}, {"threads", num_threads()}};
    for (const auto& [name, value] : measurements) json[name] = value;
    fmt::print("{}\n", json.dump(1));
    return;
  }
  std::vector<std::vector<std::string>> rows;
  for (const auto& [name, value] : measurements) rows.push_back({name, fmt::format("{:.6g}", value)});
  print(rows);
}

int fail(int code, const std::string& message) {
  fmt::print(stderr, "resilin: {}\n", message);
  return code;
}

int main(int argc, char** argv) {
  Command command;
  CLI::App app("List the built-in benchmarks, or run one", "resilin bench");
  app.add_option("name", command.name, "Name of a benchmark");
  app.add_option("--n", command.options.n, "Size of the problem, where it has one")
      ->check(CLI::Range(1, 1000));
  app.add_flag("--dynamic", command.options.dynamic,
               "Dynamic instead of static analysis, where a benchmark has both");
  app.add_option("--element", command.options.element,
                 "Element of the benchmarks kernels, bar and damping: P1, P2 or P2P0");
  app.add_option("--threads", command.threads, "Number of threads; default RESILIN_THREADS or all cores")
      ->check(CLI::Range(1, max_threads));
  app.add_flag("--json", command.json, "Print JSON");
  app.footer("Example:\n  resilin bench cube --threads 1 --json");
  try {
    app.parse(argc, argv);
    preferred_instruction_set();
    num_threads();
    choose_blas_kernel();
    run(command);
  } catch (const CLI::Success& success) {
    return app.exit(success);
  } catch (const CLI::ParseError& error) {
    return fail(1, std::string(error.what()) + "; see resilin bench --help");
  } catch (const InputError& error) {
    return fail(1, error.what());
  } catch (const std::bad_alloc& error) {
    return fail(1, out_of_memory_text(error));
  } catch (const std::exception& error) {
    return fail(3, std::string("internal error: ") + error.what());
  }
  return 0;
}

}  // namespace
}  // namespace resilin::bench

int main(int argc, char** argv) { return resilin::bench::main(argc, argv); }
