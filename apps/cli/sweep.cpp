#include "resilin/sweep/sweep.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "command.hpp"
#include "interrupt.hpp"
#include "resilin/core/error.hpp"
#include "resilin/core/parallel.hpp"
#include "resilin/core/text.hpp"
#include "resilin/core/thread_count.hpp"
#include "resilin/sweep/scene_run.hpp"
#include "resilin/sweep/sweep_folder.hpp"
#include "resilin/sweep/sweep_run.hpp"
#include "sweep_progress.hpp"
#include "terminal.hpp"

namespace resilin::cli {
namespace {

struct SweepOptions {
  std::string file;
  std::string out;
  std::string shard;
  int jobs = 0;
  int threads = 0;
  bool is_dry = false;
  bool retries_failed = false;
  bool updates = false;
  bool quiet = false;
};

std::filesystem::path sweep_out_folder(const SweepOptions& options) {
  if (!options.out.empty()) return options.out;
  return std::filesystem::path("out") / std::filesystem::path(options.file).stem();
}

int jobs_of(const SweepOptions& options, const Sweep& sweep) {
  return options.jobs > 0 ? options.jobs : jobs_for(sweep, num_threads());
}

std::string jobs_text(int jobs) {
  const int each = std::max(1, num_threads() / jobs);
  return fmt::format("{} at once, {} each", jobs, each == 1 ? "1 thread" : fmt::format("{} threads", each));
}

/// Seconds that a scene takes, from the first of a shard, which is run for it and not kept; after ten seconds
/// the share that is done has to do.
std::optional<double> measured_seconds(const Sweep& sweep, const Shard& shard) {
  constexpr double longest = 10;
  if (shard.num_scenes(sweep.size()) == 0) return std::nullopt;
  const Stopwatch stopwatch;
  const std::optional<SceneRow> row = run_scene(
      sweep, shard.number - 1, {}, [&] { return is_interrupted() || stopwatch.seconds() > longest; });
  if (is_interrupted()) throw Interrupted();
  if (row && row->status == SceneStatus::done) return row->seconds;
  return std::nullopt;
}

/// How many scenes there are and how long they will take.
int dry_run(const Sweep& sweep, const SweepOptions& options, const Shard& shard) {
  const std::filesystem::path path = sweep_out_folder(options);
  SweepCount count{.scenes = shard.num_scenes(sweep.size())};
  if (std::filesystem::exists(path / "sweep.json"))
    count = SweepFolder(path, sweep, options.updates, true).count(shard);
  const int jobs = jobs_of(options, sweep);
  const std::uint64_t left = count.left() + (options.retries_failed ? count.failed : 0);
  print_line(fmt::format("{} scenes, {}; {} to run", count.scenes, count_text(count), left));
  if (left == 0) return done;
  const std::optional<double> seconds = measured_seconds(sweep, shard);
  if (seconds) {
    print_line(fmt::format("about {}: one scene took {} here, {}",
                           format_seconds(*seconds * static_cast<double>(left) / jobs),
                           format_seconds(*seconds), jobs_text(jobs)));
  } else {
    print_line("the first scene failed or took more than 10 s, so the time is unknown");
  }
  return done;
}

void print_sweep_end(const SweepFolder& folder, const SweepProgress& end) {
  print_line(count_text(end.count) +
             fmt::format("; {} run here in {}", end.run, format_seconds(end.seconds)));
  if (end.others > 0) print_line(fmt::format("{} are being run by other processes", end.others));
  if (end.count.failed > 0)
    print_line("the table has the reason of each that failed; --retry-failed runs them again");
  if (end.is_table_written) print_line("results: " + (folder.path() / table_name).string());
}

int sweep(const SweepOptions& options) {
  catch_interrupts();
  if (options.threads > 0) set_num_threads(options.threads);
  const Shard shard = options.shard.empty() ? Shard{} : parse_shard(options.shard);
  const Sweep sweep = read_sweep(options.file);
  if (options.is_dry) return dry_run(sweep, options, shard);
  SweepFolder folder(sweep_out_folder(options), sweep, options.updates);
  const int jobs = jobs_of(options, sweep);
  if (!options.quiet)
    print_line(fmt::format("{}: {} scenes{}, {}", options.file, sweep.size(),
                           options.shard.empty() ? "" : ", shard " + options.shard, jobs_text(jobs)));
  SweepProgressLine line(Progress::style_for_stdout(options.quiet));
  const SweepProgress end =
      run_sweep(folder, {.queue = {.shard = shard, .retries_failed = options.retries_failed},
                         .jobs = jobs,
                         .is_stopped = [] { return is_interrupted() || nobody_reads_output(); },
                         .progress = [&line](const SweepProgress& progress) { line.show(progress); }});
  line.end();
  if (!options.quiet) print_sweep_end(folder, end);
  if (end.is_stopped) {
    if (nobody_reads_output()) return wrong_input;  // main says so
    print_error(options.file + ": stopped by " + interrupter() + " with " + count_text(end.count) +
                "; the same command continues");
    return not_converged;
  }
  return end.count.failed > 0 ? not_converged : done;
}

}  // namespace

void add_sweep(CommandLine& line, Action& action) {
  auto options = std::make_shared<SweepOptions>();
  const Command command =
      line.command("sweep", "Parameter sweep: run a base scene with many parameter values");
  command.option("sweep", options->file, "Sweep file (TOML); its keys are listed in docs/sweep.md")
      .required()
      .is_file({"toml"});
  command.option("--out", options->out, "Folder for the results; default out/<name of the sweep>")
      .type_name("DIR")
      .is_folder()
      .group("Results");
  command.option("--shard", options->shard, "Run part i of n; the parts share the folder")
      .type_name("i/n")
      .group("Selection");
  command
      .option("--jobs", options->jobs,
              "Number of scenes run at once; default: one per thread if they are small")
      .between(1, max_threads)
      .group("Computing");
  command
      .option("--threads", options->threads,
              "Number of threads of all scenes together; default RESILIN_THREADS or all cores")
      .between(1, max_threads)
      .group("Computing");
  command.flag("--dry-run", options->is_dry, "Print the number of scenes and the expected time")
      .group("Selection");
  command.flag("--retry-failed", options->retries_failed, "Run failed scenes again").group("Selection");
  command
      .flag("--update", options->updates,
            "After a change of the sweep: keep rows that still belong to it, run the rest")
      .group("Selection");
  command.flag("--quiet", options->quiet, "Print nothing but errors").group("Results");
  command.footer(
      "Examples:\n  resilin sweep stiffness.toml --dry-run\n  resilin sweep stiffness.toml --out "
      "out/stiffness "
      "--shard 2/8\n\n"
      "A finished scene is never run again: after a crash, a kill or Ctrl-C the same command\ncontinues. The "
      "table is results.csv; as Parquet: python -c 'import resilin;\n"
      "resilin.read_sweep(\"out/stiffness\").to_parquet()'.\n\n"
      "Exit codes: 0 all done; 1 the input is wrong; 2 some scenes failed, or the sweep was stopped; 3 an\n"
      "internal error.");
  command.on_chosen([options, &action] { action = [options] { return sweep(*options); }; });
}

}  // namespace resilin::cli
