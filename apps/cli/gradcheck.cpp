#include <fmt/format.h>

#include <cmath>
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

std::string limit_text(const DifferenceLimit& limit) {
  return fmt::format("{:.6g} +- {:.1g}", limit.value, limit.error);
}

/// Conclusion from the numbers; empty where they agree.
std::string finding(const GradientCheck& check) {
  const DifferenceLimits& limits = check.limits;
  switch (check.verdict()) {
    case Verdict::agrees:
      return "";
    case Verdict::is_within:
      return "finite differences have not fully converged: they extrapolate to " +
             limit_text(limits.central) + ", and the derivative agrees within the error";
    case Verdict::no_digits:
      return "finite differences have no digits here: the result hardly depends on the parameter, and three "
             "step sizes disagree; they neither confirm nor contradict the derivative";
    case Verdict::kink:
      return "there is a kink: backward differences give " + limit_text(limits.before) +
             ", forward differences give " + limit_text(limits.after) +
             ", and the derivative is no farther from these than they are apart";
    case Verdict::open:
      return "finite differences do not converge as their steps become smaller: they neither confirm nor "
             "contradict the derivative (runs may end in one of several equilibria, cross kinks of contact "
             "within the shortest step, or take other steps than the run itself)";
    case Verdict::differs:
      break;
  }
  if (!std::isfinite(check.slope)) return "the derivative is not a number";
  if (limits.are_kinked())
    return "the derivative is wrong: backward differences give " + limit_text(limits.before) +
           ", forward differences give " + limit_text(limits.after) + ", and it is far from both";
  return "the derivative is wrong: finite differences give " + limit_text(limits.central);
}

int gradcheck(const GradcheckOptions& options) {
  const Scene scene = read_scene(options.scene, {.overrides = options.overrides});
  print_warnings(scene.warnings);
  catch_interrupts();
  std::vector<std::string> warnings;
  const std::vector<GradientCheck> checks = check_gradients(
      scene.description, options.wrt, [] { return !is_interrupted(); },
      [&warnings](const std::string& line) { warnings.push_back(line); });
  print_warnings(warnings);
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
  std::size_t agree = 0;
  bool is_confirmed = true;
  for (const GradientCheck& check : checks) {
    const Verdict verdict = check.verdict();
    if (verdict == Verdict::agrees) ++agree;
    is_confirmed = is_confirmed && verdict != Verdict::open && verdict != Verdict::differs;
    if (const std::string line = finding(check); !line.empty())
      print_line(one_line(check.parameter) + ": " + line);
  }
  if (agree > 0)
    print_line((agree < checks.size() ? "all other" : std::string("all")) +
               " derivatives agree with finite differences");
  return is_confirmed ? done : not_converged;
}

}  // namespace

void add_gradcheck(CommandLine& line, Action& action) {
  auto options = std::make_shared<GradcheckOptions>();
  const Command command = line.command("gradcheck", "Verify the derivatives of a run by finite differences");
  command.option("scene", options->scene, "Scene file (.toml)").required().is_file({"toml"});
  command
      .option("--wrt", options->wrt,
              "Parameter, such as body.beam.material.youngs_modulus; repeatable; default: all")
      .type_name("KEY")
      .repeatable();
  command.option("--set", options->overrides, "Change a value of the scene first; repeatable")
      .type_name("KEY=VALUE")
      .repeatable()
      .offers(scene_settings);
  command.footer(
      "The function is a weighted sum of all final nodal positions, each with a weight of its "
      "own.\n"
      "Example:\n  resilin gradcheck beam.toml --wrt body.beam.material.youngs_modulus\n\n"
      "Exit codes: 0 they agree within the accuracy of differences; 1 invalid input; 2 they disagree, "
      "or "
      "differences do not converge.");
  command.on_chosen([options, &action] { action = [options] { return gradcheck(*options); }; });
}

}  // namespace resilin::cli
