#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "command.hpp"
#include "interrupt.hpp"
#include "offered_words.hpp"
#include "resilin/core/text.hpp"
#include "resilin/scene/scene.hpp"
#include "resilin/sensitivity/gradient_check.hpp"
#include "terminal.hpp"

namespace resilin::cli {
namespace {

struct GradcheckOptions {
  std::string scene;
  std::vector<std::string> wrt, overrides;
};

using Verdict = GradientCheck::Verdict;

std::string number_text(double number) { return fmt::format("{:.10g}", number); }

int gradcheck(const GradcheckOptions& options) {
  const Scene scene = read_scene(options.scene, {.overrides = options.overrides});
  print_warnings(scene.warnings);
  catch_interrupts();
  const std::vector<GradientCheck> checks =
      check_gradients(scene.description, options.wrt, [] { return !is_interrupted(); });
  std::vector<std::vector<std::string>> rows = {{"parameter", "adjoint"}};
  for (const double step : checks.front().steps) rows[0].push_back("difference, step " + format_short(step));
  rows[0].emplace_back("digits");
  for (const GradientCheck& check : checks) {
    const std::string size =
        check.size == 1 ? "" : " (along one change of all " + std::to_string(check.size) + ")";
    std::vector<std::string> row = {one_line(check.parameter) + size, number_text(check.slope)};
    for (const double difference : check.differences) row.push_back(number_text(difference));
    row.push_back(check.verdict() == Verdict::no_digits ? "-"
                                                        : std::to_string(static_cast<int>(check.digits)));
    rows.push_back(std::move(row));
  }
  print_text(format_table(rows));
  const auto count = [&](Verdict verdict) {
    return std::ranges::count(checks, verdict, &GradientCheck::verdict);
  };
  const auto total = std::to_string(checks.size());
  const auto agree = count(Verdict::agrees), unseen = count(Verdict::no_digits),
             wrong = count(Verdict::differs);
  if (unseen > 0)
    print_line(
        std::to_string(unseen) + " of " + total +
        ": the differences have no digits here: the result hardly depends on it, and at three steps they "
        "disagree among themselves; they neither confirm the derivative nor contradict it");
  if (wrong > 0) {
    print_line(
        std::to_string(wrong) + " of " + total +
        " do not agree with differences of runs: a step may cross a kink (contact that begins or ends, "
        "buckling), or the derivative is wrong");
    return not_converged;
  }
  if (agree > 0)
    print_line((unseen > 0 ? "all other" : std::string("all")) +
               " derivatives agree with differences of runs");
  return done;
}

}  // namespace

void add_gradcheck(CommandLine& line, Action& action) {
  auto options = std::make_shared<GradcheckOptions>();
  const Command command =
      line.command("gradcheck", "Compare the derivatives of a run with differences of runs");
  command.option("scene", options->scene, "Scene file (.toml)").required().is_file({"toml"});
  command
      .option("--wrt", options->wrt,
              "A parameter by its key, such as body.beam.material.youngs_modulus; may be given several "
              "times; all where none is given")
      .type_name("KEY")
      .repeatable();
  command.option("--set", options->overrides, "Change a value of the scene first; may be given several times")
      .type_name("KEY=VALUE")
      .repeatable()
      .offers(scene_settings);
  command.footer(
      "What is differentiated is a sum of the places of all nodes at the end, each with a weight of its "
      "own.\n"
      "Example:\n  resilin gradcheck beam.toml --wrt body.beam.material.youngs_modulus\n\n"
      "Exit codes: 0 they agree, or have no digits to compare with; 1 the input is wrong; 2 they do not "
      "agree.");
  command.on_chosen([options, &action] { action = [options] { return gradcheck(*options); }; });
}

}  // namespace resilin::cli
