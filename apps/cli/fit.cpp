#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "command.hpp"
#include "resilin/core/error.hpp"
#include "resilin/core/text.hpp"
#include "resilin/fit/fit_file.hpp"
#include "resilin/fit/fit_output.hpp"
#include "resilin/fit/fit_report.hpp"
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
  const FitReport report = fit_materials(read_fit(options.data, overrides));
  const std::filesystem::path folder =
      options.out.empty() ? std::filesystem::path("out") / std::filesystem::path(options.data).stem()
                          : std::filesystem::path(options.out);
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

}  // namespace

void add_fit(CommandLine& line, Action& action) {
  auto options = std::make_shared<FitOptions>();
  const Command command = line.command(
      "fit", "Find the constants of laws from tests, with intervals and their range of stability");
  command.option("data", options->data, "The tests (.toml)");
  command.option("--laws", options->laws, "Laws to fit, or all; default: those of the file")
      .separated_by(',')
      .type_name("LAW,...");
  command.option("--out", options->out,
                 "Folder of fit.html, fit.json and material.toml; default: out/NAME of the file");
  command.option("--set", options->overrides, "Change a value of the file first; may be given several times")
      .type_name("KEY=VALUE")
      .repeatable();
  command.flag("--json", options->json, "Print fit.json instead of the table");
  command.flag("--quiet", options->quiet, "Print nothing but warnings");
  command.flag("--reference", options->reference, "Print the page docs/fit_keys.md");
  command.footer(
      "Example:\n  resilin fit examples/fit_rubber.toml --laws yeoh,ogden2\n\nExit codes: 0 fitted; 1 the "
      "data are wrong.");
  command.on_chosen([options, &action] { action = [options] { return fit(*options); }; });
}

}  // namespace resilin::cli
