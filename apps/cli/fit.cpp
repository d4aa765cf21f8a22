#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "command.hpp"
#include "interrupt.hpp"
#include "offered_words.hpp"
#include "resilin/core/error.hpp"
#include "resilin/core/text.hpp"
#include "resilin/fit/fit_file.hpp"
#include "resilin/fit/fit_output.hpp"
#include "resilin/fit/fit_report.hpp"
#include "resilin/fit/scene_fit.hpp"
#include "terminal.hpp"

namespace resilin::cli {
namespace {

struct FitOptions {
  std::string data;
  std::string out;
  std::vector<std::string> laws, overrides;
  bool json = false;
  bool quiet = false;
  bool reference = false;
};

/// --laws in the words of the file.
std::string laws_override(const std::vector<std::string>& laws) {
  if (laws == std::vector<std::string>{"all"}) return "fit.laws=all";
  std::string list;
  for (const std::string& law : laws) list += (list.empty() ? "\"" : ", \"") + law + "\"";
  return "fit.laws=[" + list + "]";
}

std::filesystem::path folder_of(const FitOptions& options) {
  return options.out.empty() ? std::filesystem::path("out") / std::filesystem::path(options.data).stem()
                             : std::filesystem::path(options.out);
}

int fit_tests(FitDescription description, const FitOptions& options, const Stopwatch& watch) {
  const FitReport report = fit_materials(std::move(description));
  const std::filesystem::path folder = folder_of(options);
  write_fit(report, folder);
  if (options.json) {
    print_text(fit_json_text(report));
  } else if (!options.quiet) {
    print_text(fit_text(report));
    print_line("\n" + one_line((folder / "fit.html").string()) +
               ", material.toml and fit.json are written; " + format_seconds(watch.seconds()));
  }
  print_warnings(report.warnings);
  return done;
}

int fit_experiments(SceneFitDescription description, const FitOptions& options, const Stopwatch& watch) {
  print_warnings(description.warnings);
  catch_interrupts();
  const bool is_told = !options.json && !options.quiet;
  const SceneFitReport report =
      fit_scenes(std::move(description), {.on_solve =
                                              [is_told](const SceneFitStep& step) {
                                                if (!is_told) return;
                                                print_line(scene_fit_step_text(step));
                                                flush_output();
                                              },
                                          .goes_on = [] { return !is_interrupted(); }});
  const std::filesystem::path folder = folder_of(options);
  write_scene_fit(report, folder);
  if (options.json) {
    print_text(scene_fit_json_text(report));
  } else if (is_told) {
    print_text("\n" + scene_fit_text(report));
    print_line("\n" + one_line((folder / "fit.html").string()) +
               ", material.toml and fit.json are written; " + format_seconds(watch.seconds()));
  }
  print_warnings(report.estimates.warnings);
  return report.is_converged ? done : not_converged;
}

int fit_prony(RelaxationDescription description, const FitOptions& options, const Stopwatch& watch) {
  const RelaxationFit found = fit_relaxation(std::move(description));
  const std::filesystem::path folder = folder_of(options);
  write_relaxation(found, folder);
  if (options.json) {
    print_text(relaxation_json_text(found));
  } else if (!options.quiet) {
    print_text(relaxation_text(found));
    print_line("\n" + one_line((folder / "fit.html").string()) +
               ", material.toml and fit.json are written; " + format_seconds(watch.seconds()));
  }
  return done;
}

int fit(const FitOptions& options) {
  if (options.reference) {
    print_text(fit_reference());
    return done;
  }
  if (options.data.empty())
    throw InputError("fit", "the file of the tests", "nothing",
                     "for example resilin fit examples/fit_rubber.toml");
  const Stopwatch watch;
  std::vector<std::string> overrides = options.overrides;
  if (!options.laws.empty()) overrides.push_back(laws_override(options.laws));
  AnyFit asked = read_any_fit(options.data, overrides);
  if (auto* scenes = std::get_if<SceneFitDescription>(&asked))
    return fit_experiments(std::move(*scenes), options, watch);
  if (auto* relaxation = std::get_if<RelaxationDescription>(&asked))
    return fit_prony(std::move(*relaxation), options, watch);
  return fit_tests(std::move(std::get<FitDescription>(asked)), options, watch);
}

}  // namespace

void add_fit(CommandLine& line, Action& action) {
  auto options = std::make_shared<FitOptions>();
  const Command command = line.command(
      "fit",
      "Calibrate material models from tests, or identify parameters of scenes from markers and forces");
  command
      .option("data", options->data,
              "File of tests, of a relaxation, or of experiments with their scenes (.toml)")
      .is_file({"toml"});
  command.option("--laws", options->laws, "Constitutive models to fit, or all; default: those of the file")
      .separated_by(',')
      .type_name("LAW,...")
      .offers(law_words);
  command
      .option("--out", options->out,
              "Folder of fit.html, fit.json and material.toml; default: out/NAME of the file")
      .type_name("DIR")
      .is_folder();
  command.option("--set", options->overrides, "Change a value of the file first; repeatable")
      .type_name("KEY=VALUE")
      .repeatable();
  command.flag("--json", options->json, "Print fit.json instead of the table");
  command.flag("--quiet", options->quiet, "Print nothing but warnings");
  command.flag("--reference", options->reference, "Print the page docs/fit_keys.md");
  command.footer(
      "A file with [[test]] fits models to homogeneous tests and ranks them. One with [[experiment]] and\n"
      "[[parameter]] identifies parameters of scenes from displacements of markers, reactions and "
      "probes,\nand prints one line per solve. One with [relaxation] gives a Prony series.\n"
      "Examples:\n  resilin fit examples/fit_rubber.toml --laws yeoh,ogden2\n"
      "  resilin fit examples/fit_bar.toml\n\n"
      "Exit codes: 0 fitted; 1 the data are wrong; 2 the search did not converge.");
  command.on_chosen([options, &action] { action = [options] { return fit(*options); }; });
}

}  // namespace resilin::cli
