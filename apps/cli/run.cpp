#include <fmt/format.h>
#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "command.hpp"
#include "conditions.hpp"
#include "interrupt.hpp"
#include "log_file.hpp"
#include "offered_words.hpp"
#include "progress.hpp"
#include "resilin/core/error.hpp"
#include "resilin/core/log.hpp"
#include "resilin/core/parallel.hpp"
#include "resilin/core/text.hpp"
#include "resilin/core/thread_count.hpp"
#include "resilin/results/results.hpp"
#include "resilin/results/run.hpp"
#include "resilin/results/saved_report.hpp"
#include "resilin/scene/scene.hpp"
#include "run_together.hpp"
#include "terminal.hpp"

namespace resilin::cli {
namespace {

RunOutcome simulate(Simulation& simulation, ResultFolder& results, Progress& progress, int max_steps) {
  results.record(simulation, false);
  const RunHooks hooks{
      .is_stopped = [] { return is_interrupted() || nobody_reads_output(); },
      .after_iteration = [&](const NewtonReport& so_far) { progress.iteration(so_far); },
      .after_step =
          [&](const StepReport& report) {
            results.record(simulation, simulation.is_finished());
            progress.step(simulation, report);
          },
      .stopper = [] { return is_interrupted() ? interrupter() : "a closed pipe, where its output goes,"; },
      .max_steps = max_steps};
  RunOutcome outcome = run_to_end(simulation, hooks);
  if (outcome.status == RunStatus::budget) outcome.reason += "; --resume continues";
  return outcome;
}

void resume(Simulation& simulation, ResultFolder& results, Resume rule, std::vector<std::string>& warnings) {
  const std::string place = (results.path() / "checkpoint.bin").string();
  const ResultFolder::Resumed resumed = results.resume(simulation, rule);
  if (!resumed.has_checkpoint) {
    warnings.push_back(place + ": no checkpoint; the run starts from the beginning");
    return;
  }
  if (resumed.difference)
    warnings.push_back(place + ": checkpoint of another scene, used anyway: " + *resumed.difference);
  log_info("resumed at " + reached(simulation));
}

void print_start(const RunOptions& options, const Simulation& simulation) {
  const World& world = simulation.world();
  Offset cells = 0;
  for (const Body& body : world.bodies) cells += body.num_cells();
  print_line(one_line(world.title.empty() ? options.scene : world.title) + ": " +
             std::to_string(world.bodies.size()) + (world.bodies.size() == 1 ? " body, " : " bodies, ") +
             std::to_string(cells) + (cells == 1 ? " cell, " : " cells, ") +
             std::to_string(world.num_free_unknowns()) + " DOFs, " + std::string(simulation.solver_name()) +
             ", " + std::to_string(num_threads()) + (num_threads() == 1 ? " thread" : " threads"));
  constexpr std::size_t most_conditions = 10;  // lines of each kind
  print_conditions(world, most_conditions);
}

void print_modes(const std::vector<VibrationMode>& modes) {
  for (std::size_t k = 0; k < modes.size(); ++k) {
    const VibrationMode& mode = modes[k];
    const std::string word = mode.is_rigid ? " (rigid)" : mode.is_unstable() ? " (unstable)" : "";
    print_line("mode " + std::to_string(k + 1) + ": " + fmt::format("{:.6g} Hz", mode.frequency()) + word);
  }
}

/// One line, of all bodies.
void print_discretisation_errors(const World& world, const DiscretisationErrors& errors) {
  std::vector<std::string> parts;
  for (std::size_t b = 0; b < errors.size(); ++b)
    if (const auto& error = errors[b]) {
      const bool is_weak = error->estimate == ErrorEstimate::recovered_stress && error->share != cannot_tell;
      parts.push_back(share_text(error->share) + " (" + world.bodies[b].name + ", " +
                      world.bodies[b].element + (is_weak ? ", by recovered stress)" : ")"));
    }
  if (!parts.empty()) print_line("estimated discretisation error: " + join(parts));
}

/// The stiffness along each axis of those supports that ask for it.
void print_stiffness(const std::vector<SupportStiffness>& all, int dim) {
  for (const SupportStiffness& each : all) {
    Vector3 along = Vector3::Zero();
    for (int k = 0; k < dim; ++k)
      along[k] = each.by_displacement[static_cast<std::size_t>(k) * static_cast<std::size_t>(dim) +
                                      static_cast<std::size_t>(k)];
    print_line("stiffness of " + one_line(each.name) + ": " + vector_text(along, dim) + " N/m" +
               (each.by_rotation ? ", " + format_short(*each.by_rotation) + " N m/rad" : ""));
  }
}

void print_end(const Simulation& simulation, const ResultFolder& results, const RunOutcome& outcome,
               double setup_seconds, double total) {
  const Frame& frame = simulation.frame();
  const int dim = simulation.world().dimension;
  print_modes(simulation.modes());
  print_probes_and_reactions(frame, dim);
  for (const SurfaceContact::BodyContact& contact : frame.contacts) {
    const auto name_of = [&](Index body) {
      return one_line(simulation.world().bodies[static_cast<std::size_t>(body)].name);
    };
    const std::string gap = "gap " + format_short(contact.gap) + " m";
    print_line(
        "contact of " + name_of(contact.body) + " with " +
        (contact.body == contact.other
             ? "itself: " + gap  // its forces on itself have no sum
             : name_of(contact.other) + ": " + vector_text(contact.force, dim) + " N on the latter, " + gap));
  }
  print_stiffness(outcome.stiffness, dim);
  print_line("smallest volume ratio " + format_short(frame.min_volume_ratio));
  print_discretisation_errors(simulation.world(), outcome.discretisation_errors);
  const Timing& timing = simulation.timing();
  print_line(std::string(name(outcome.status)) + ": " + outcome.reason);
  print_line("took " + format_seconds(total) + " (set-up " + format_seconds(setup_seconds) + ", assembly " +
             format_seconds(timing.assembly) + ", solving " + format_seconds(timing.solve) +
             ", error estimate " + format_seconds(outcome.estimate_seconds) + ", output " +
             format_seconds(results.output_seconds()) + ")");
  std::string files = "results: " + (results.path() / "report.json").string();
  const std::filesystem::path list = results.path() / "frames.pvd";
  if (simulation.world().output.writes(OutputFormat::vtu))
    files += ", " + list.string() + " (opens in ParaView)";
  for (const auto& [name, size] : results.shown_files()) {
    files += ", " + (results.path() / name).string() + " (" + format_bytes(size) +
             (name.ends_with(".html") ? ", opens in a browser)" : ")");
  }
  print_line(files);
}

int run(const RunOptions& options) {
  if (const std::optional<int> code = run_together(options)) return *code;
  catch_interrupts();
  const Stopwatch stopwatch;
  if (options.threads > 0) set_num_threads(options.threads);
  Scene scene = read_scene(options.scene, {.overrides = overrides(options)});
  Simulation simulation(std::move(scene.description));
  ResultFolder results(out_folder(options), stopwatch.seconds());
  const LogFile log(results.path() / "log.txt", options.resumes());
  if (!results.previous_holder().empty())
    log_info("the folder was left by " + results.previous_holder() + ", which did not end its run");
  std::vector<std::string> warnings = std::move(scene.warnings);
  for (std::string& warning : all_warnings(simulation.world())) warnings.push_back(std::move(warning));
  if (options.resumes()) {
    const Resume rule = options.resume == resume_anyway ? Resume::anyway : Resume::same_scene;
    resume(simulation, results, rule, warnings);
  }
  for (const std::string& note : simulation.world().notes) log_info(note);
  for (const std::string& warning : warnings) log_warning(warning);
  if (!options.quiet) print_warnings(warnings);
  if (!options.quiet) print_start(options, simulation);

  const double setup_seconds = stopwatch.seconds();
  Progress progress(Progress::style_for_stdout(options.quiet), simulation);
  RunOutcome outcome;
  try {
    outcome = simulate(simulation, results, progress, options.steps);
  } catch (...) {
    mark_as_failed(results.path() / "report.json");
    throw;
  }
  progress.end();
  for (const std::string& warning : outcome.warnings) log_warning(warning);
  if (!options.quiet) print_warnings(outcome.warnings);
  outcome.warnings.insert(outcome.warnings.begin(), warnings.begin(), warnings.end());
  try {
    results.record(simulation, true);
    results.finish(simulation, outcome);
  } catch (...) {
    mark_as_failed(results.path() / "report.json");
    throw;
  }
  log_info(std::string(name(outcome.status)) + ": " + outcome.reason);
  if (!options.quiet) print_end(simulation, results, outcome, setup_seconds, stopwatch.seconds());
  if (outcome.status == RunStatus::done) return done;
  if (nobody_reads_output()) return wrong_input;  // main says so
  print_error(options.scene + ": " + outcome.reason);
  return not_converged;
}

}  // namespace

void add_run(CommandLine& line, Action& action) {
  auto options = std::make_shared<RunOptions>();
  const Command command = line.command("run", "Simulate a scene");
  command.option("scene", options->scene, "Scene file (TOML); its keys are listed in docs/scene.md")
      .required()
      .is_file({"toml"});
  command.option("--set", options->overrides, "Change a value of the scene; repeatable")
      .type_name("KEY=VALUE")
      .repeatable()
      .group("Scene")
      .offers(scene_settings);
  command.option("--out", options->out, "Folder for the results; default out/<name of the scene>")
      .type_name("DIR")
      .is_folder()
      .group("Results");
  command
      .option("--formats", options->formats,
              "What to write in place of the scene's output.formats, such as html,usda")
      .separated_by(',')
      .one_of({"vtu", "html", "usda"})
      .values(1, 1)
      .joins_repeats()
      .group("Results");
  command.option("--threads", options->threads, "Number of threads; default RESILIN_THREADS or all cores")
      .between(1, max_threads)
      .group("Computing");
  command.option("--steps", options->steps, "Stop after this many steps")
      .between(1, 1000000000)
      .group("Computing");
  command
      .flag_with_word("--resume", options->resume, "same",
                      "Restart from the checkpoint in the folder; the scene must be the same, unless "
                      "--resume=anyway")
      .one_of({"same", resume_anyway})
      .group("Computing");
  command.flag("--quiet", options->quiet, "Print nothing but errors").group("Results");
  command.footer(
      "Example:\n  resilin run beam.toml --out out/stiff --set body.beam.material.youngs_modulus=1e7\n\n"
      "Exit codes: 0 done; 1 invalid input or out of memory; 2 did not converge or was "
      "stopped\n(results so far are kept); 3 an internal error. After Ctrl-C, SIGTERM or SIGHUP --resume "
      "continues.");
  command.on_chosen([options, &action] { action = [options] { return run(*options); }; });
}

}  // namespace resilin::cli
