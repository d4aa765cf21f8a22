#include <exception>

#include "command.hpp"
#include "interrupt.hpp"
#include "log_file.hpp"
#include "progress.hpp"
#include "resilin/core/error.hpp"
#include "resilin/core/log.hpp"
#include "resilin/core/memory.hpp"
#include "resilin/core/parallel.hpp"
#include "resilin/core/text.hpp"
#include "resilin/petsc/shared_results.hpp"
#include "resilin/petsc/shared_scene.hpp"
#include "resilin/results/run.hpp"
#include "resilin/scene/scene.hpp"
#include "run_together.hpp"
#include "terminal.hpp"

namespace resilin::cli {
namespace {

/// The first process speaks for all.
class Speaker {
 public:
  Speaker(bool is_first, bool is_quiet) : is_first_(is_first), is_quiet_(is_quiet) {}

  bool is_first() const { return is_first_; }
  bool is_silent() const { return !is_first_ || is_quiet_; }
  void line(const std::string& text) const {
    if (!is_silent()) print_line(text);
  }
  void warnings(const std::vector<std::string>& texts) const {
    if (!is_first_) return;
    for (const std::string& text : texts) log_warning(text);
    if (!is_quiet_) print_warnings(texts);
  }
  void error(const std::string& text) const {
    if (is_first_) print_error(text);
  }

 private:
  bool is_first_, is_quiet_;
};

void print_start(const Speaker& speaker, const RunOptions& options, const SharedScene& scene,
                 const Simulation& simulation) {
  const World& world = *scene.world;
  const std::size_t bodies = world.bodies.size();
  speaker.line(one_line(world.title.empty() ? options.scene : world.title) + ": " + std::to_string(bodies) +
               (bodies == 1 ? " body, " : " bodies, ") + std::to_string(scene.whole.num_cells) +
               (scene.whole.num_cells == 1 ? " cell, " : " cells, ") +
               std::to_string(scene.whole.num_free_unknowns) + " DOFs, " +
               std::string(simulation.solver_name()) + ", " + std::to_string(num_processes()) + " processes");
}

/// Logs the traffic per MPI rank and Newton iteration, and the memory of the largest rank.
void log_traffic(const SharedScene& scene, int iterations) {
  const ProcessGroup& share = scene.world->share;
  const Traffic traffic = scene.exchange->traffic();
  const double ranks = num_processes();
  const double messages = share.sum(static_cast<double>(traffic.messages)) / ranks;
  const double bytes = share.sum(static_cast<double>(traffic.bytes)) / ranks;
  const double memory = share.largest(memory_in_use());
  const double per = std::max(1, iterations);
  if (share.is_first())
    log_info("beside PETSc's own, each process sent " + format_short(messages / per) + " messages with " +
             format_short(bytes / per) + " bytes and joined " +
             format_short(static_cast<double>(traffic.sums) / per) + " global sums for each of " +
             std::to_string(iterations) + " Newton iterations; the largest holds " +
             format_short(memory / (1 << 20)) + " MiB");
}

std::vector<std::string> resume(const RunOptions& options, SharedResults& results, Simulation& simulation) {
  const std::string place = (out_folder(options) / "checkpoint.bin").string();
  const Resume rule = options.resume == resume_anyway ? Resume::anyway : Resume::same_scene;
  const SharedResults::Resumed resumed = results.resume(simulation, rule);
  if (!resumed.has_checkpoint) return {place + ": no checkpoint; the run starts from the beginning"};
  log_info("resumed at " + reached(simulation));
  if (!resumed.difference) return {};
  return {place + ": checkpoint of another scene, used anyway: " + *resumed.difference};
}

RunOutcome simulate(const SharedScene& scene, Simulation& simulation, SharedResults& results,
                    Progress& progress, const RunOptions& options) {
  const ProcessGroup& share = scene.world->share;
  int iterations = 0;
  results.record(simulation, false);
  const RunHooks hooks{
      .is_stopped = [&] { return share.any(is_interrupted() || nobody_reads_output()); },
      .after_iteration = [&](const NewtonReport& so_far) { progress.iteration(so_far); },
      .after_step =
          [&](const StepReport& report) {
            iterations += report.newton.iterations;
            results.record(simulation, simulation.is_finished());
            progress.step(simulation, report);
          },
      .stopper = [] { return is_interrupted() ? interrupter() : "another process, or a closed pipe,"; },
      .max_steps = options.steps};
  RunOutcome outcome = run_to_end(simulation, hooks);
  if (outcome.status == RunStatus::budget) outcome.reason += "; --resume continues";
  log_traffic(scene, iterations);
  return outcome;
}

int run_part(const RunOptions& options, const Speaker& speaker) {
  const Stopwatch stopwatch;
  set_num_threads(options.threads > 0 ? options.threads : 1);
  std::vector<std::string> warnings;
  const auto read = [&] {
    Scene scene = read_scene(options.scene, {.overrides = overrides(options)});
    warnings = std::move(scene.warnings);
    return std::move(scene.description);
  };
  const SharedScene scene = share_scene(read);
  std::optional<Simulation> made;
  on_all_processes([&] { made.emplace(*scene.world); });
  Simulation& simulation = *made;
  SharedResults results(out_folder(options), scene, stopwatch.seconds());
  std::optional<LogFile> log;
  if (speaker.is_first()) log.emplace(out_folder(options) / "log.txt", options.resumes());
  for (const std::string& warning : scene.whole.warnings) warnings.push_back(warning);
  if (options.resumes())
    for (const std::string& warning : resume(options, results, simulation)) warnings.push_back(warning);
  for (const std::string& note : scene.whole.notes) log_info(note);
  log_info("a run on several MPI processes writes frames for ParaView, no result.html and no result.usda");
  speaker.warnings(warnings);
  print_start(speaker, options, scene, simulation);

  const double setup_seconds = stopwatch.seconds();
  Progress progress(Progress::style_for_stdout(speaker.is_silent()), simulation);
  RunOutcome outcome = simulate(scene, simulation, results, progress, options);
  progress.end();
  speaker.warnings(outcome.warnings);
  outcome.warnings.insert(outcome.warnings.begin(), warnings.begin(), warnings.end());
  results.record(simulation, true);
  results.finish(simulation, outcome);
  if (!speaker.is_silent()) print_probes_and_reactions(simulation.frame(), scene.world->dimension);
  speaker.line("smallest volume ratio " + format_short(simulation.frame().min_volume_ratio));
  speaker.line(std::string(name(outcome.status)) + ": " + outcome.reason);
  const Timing& timing = simulation.timing();
  speaker.line("took " + format_seconds(stopwatch.seconds()) + " (set-up " + format_seconds(setup_seconds) +
               ", assembly " + format_seconds(timing.assembly) + ", solving " + format_seconds(timing.solve) +
               ", output " + format_seconds(results.output_seconds()) + ")");
  speaker.line("results: " + (out_folder(options) / "report.json").string() + ", " +
               (out_folder(options) / "frames.pvd").string() + " (opens in ParaView)");
  if (outcome.status == RunStatus::done) return done;
  speaker.error(options.scene + ": " + outcome.reason);
  return not_converged;
}

}  // namespace

int run_shared(const RunOptions& options) {
  catch_interrupts();  // before MPI makes threads
  const Speaker speaker(process_rank() == 0, options.quiet);
  // Others wait for this process: what it cannot go on from ends all of them.
  try {
    return run_part(options, speaker);
  } catch (const AgreedError& error) {
    speaker.error(error.what());
    return wrong_input;
  } catch (const InputError& error) {
    print_error(error.what());
  } catch (const std::bad_alloc& error) {
    print_error(out_of_memory_text(error));
  } catch (const std::exception& error) {
    print_error(std::string("internal error: ") + error.what());
    end_all_processes(internal_error);
  }
  end_all_processes(wrong_input);
}

}  // namespace resilin::cli
