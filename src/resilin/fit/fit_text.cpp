#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <ostream>
#include <system_error>

#include "resilin/core/error.hpp"
#include "resilin/core/spelling.hpp"
#include "resilin/core/text.hpp"
#include "resilin/fit/fit_output.hpp"
#include "resilin/io/atomic_file.hpp"

namespace resilin {
namespace {

constexpr std::size_t most_correlations_told = 3;

std::string unit_suffix(const ConstantEstimate& constant, const ShownUnit& unit) {
  return constant.unit.empty() ? "" : " " + unit.name;
}

double in_unit(const ConstantEstimate& constant, double value, const ShownUnit& unit) {
  return constant.unit.empty() ? value : value / unit.in_pascal;
}

std::string constant_line(const ConstantEstimate& constant, const ShownUnit& unit) {
  const double value = in_unit(constant, constant.value, unit);
  const double half_width = in_unit(constant, constant.half_width_95, unit);
  const std::string suffix = unit_suffix(constant, unit);
  if (!constant.is_fitted())
    return value_text(value, 0) + suffix + "  (" + spelling(constant.origin) + ", not fitted)";
  const bool has_interval = constant.is_determined && std::isfinite(half_width);
  return value_text(value, half_width) + (has_interval ? " +- " + format_short(half_width) : "") + suffix +
         (has_interval ? "" : "  (not determined)");
}

void add_law(const LawFit& fit, const FitReport& report, const ShownUnit& unit, std::string& text) {
  const bool is_absolute = report.description.residual == ResidualKind::absolute;
  const double scale = is_absolute ? unit.in_pascal * unit.in_pascal : 1;
  text += "\n" + fit.name + ": Psi = " + std::string(fit.material.law->formula) + "\n";
  std::vector<std::vector<std::string>> rows;
  for (const ConstantEstimate& constant : fit.constants) {
    if (constant.origin != ConstantOrigin::absent)
      rows.push_back({"  " + constant.name, constant_line(constant, unit)});
  }
  rows.push_back({"  sum of squares",
                  format_number(fit.sum_of_squares / scale) + (is_absolute ? " " + unit.name + "^2" : "")});
  if (!fit.stability.empty()) rows.push_back({"  stable", stability_text(fit)});
  text += format_table(rows);
  for (std::size_t i = 0; i < std::min(fit.correlations.size(), most_correlations_told); ++i)
    text += "  " + fit.correlations[i].text + "\n";
  if (fit.correlations.size() > most_correlations_told)
    text += "  and " + std::to_string(fit.correlations.size() - most_correlations_told) +
            " more pairs are correlated above 0.95 (fit.json has them)\n";
  for (const std::string& remark : fit.remarks) text += "  " + remark + "\n";
  for (const std::string& warning : fit.warnings) text += "  warning: " + warning + "\n";
}

std::string tests_line(const FitReport& report) {
  std::string text;
  for (const MaterialTest& test : report.description.tests)
    text += (text.empty() ? "" : ", ") + test.name + " (" + std::to_string(test.num_points()) + " points)";
  return text;
}

/// Four digits; "-" for a test whose points all have one stress, which has none.
std::string r_squared_text(double r_squared) {
  return std::isfinite(r_squared) ? fmt::format("{:.4f}", r_squared) : "-";
}

/// In a column of the table: whether the law is stable.
std::string stable_text(const LawFit& fit) {
  if (fit.stability.empty()) return "-";
  const bool is_lost = std::ranges::any_of(fit.warnings, [](const std::string& warning) {
    return warning.find("unstable beyond") != std::string::npos ||
           warning.find("unstable below") != std::string::npos;
  });
  return is_lost ? "in part" : fit.is_bounded ? "held" : "yes";
}

}  // namespace

ShownUnit shown_unit(const FitReport& report) {
  const std::vector<MaterialTest>& tests = report.description.tests;
  const auto uses = [&](const MaterialTest& test) {
    return std::ranges::count(tests, test.unit, &MaterialTest::unit);
  };
  const auto most = std::ranges::max_element(tests, {}, uses);
  return {most->unit, most->unit_in_pascal};
}

std::vector<std::vector<std::string>> ranking(const FitReport& report, const ShownUnit& unit) {
  std::vector<std::vector<std::string>> rows = {{"law", "constants", "AICc", "weight"}};
  for (const MaterialTest& test : report.description.tests) rows.front().push_back("R2 " + test.name);
  rows.front().insert(rows.front().end(), {"E [" + unit.name + "]", "nu"});
  for (const LawFit& fit : report.laws) {
    rows.push_back({fit.name, std::to_string(fit.num_fitted),
                    std::isfinite(fit.aicc) ? fmt::format("{:.1f}", fit.aicc) : "-",
                    fmt::format("{:.3f}", fit.akaike_weight)});
    for (const TestQuality& test : fit.tests) rows.back().push_back(r_squared_text(test.r_squared));
    rows.back().push_back(fmt::format("{:.4g}", fit.youngs_modulus / unit.in_pascal));
    rows.back().push_back(fmt::format("{:.4g}", fit.poissons_ratio));
  }
  return rows;
}

std::string value_text(double value, double half_width) {
  int digits = 6;
  if (std::isfinite(half_width) && half_width > 0 && value != 0)
    digits = std::clamp(2 + static_cast<int>(std::ceil(std::log10(std::abs(value) / half_width))), 2, 9);
  return fmt::format("{:.{}g}", value, std::max(digits, 5));
}

std::string objective_text(const FitReport& report) {
  const FitDescription& description = report.description;
  std::string text;
  switch (description.residual) {
    case ResidualKind::absolute:
      text = "absolute residuals, P_model - P_measured";
      break;
    case ResidualKind::relative:
      text = "relative residuals, (P_model - P_measured) / P_measured";
      break;
    case ResidualKind::sigma:
      text = "residuals over sigma, (P_model - P_measured) / sigma";
      break;
  }
  std::vector<std::string> weights;
  for (const MaterialTest& test : description.tests)
    weights.push_back(test.name + " " + format_number(test.weight));
  const bool all_one =
      std::ranges::all_of(description.tests, [](const MaterialTest& test) { return test.weight == 1; });
  text += all_one ? "; every point weighs the same" : "; weights: " + join(weights);
  text += report.is_compressible ? "; compressible, sides free of stress" : "; incompressible limit";
  return text + "; stability " +
         (description.stability == StabilityRule::required ? "required over the data"
          : description.stability == StabilityRule::report ? "reported"
                                                           : "not checked");
}

std::string stability_text(const StabilityRange& range) {
  const std::string mode = spelling(range.mode);
  if (range.below && range.above && *range.below == *range.above) return mode + " nowhere";
  if (range.below && range.above)
    return mode + " from " + format_short(*range.below) + " to " + format_short(*range.above);
  if (range.above) return mode + " up to " + format_short(*range.above);
  if (range.below) return mode + " from " + format_short(*range.below);
  return mode + " everywhere";
}

std::string stability_text(const LawFit& fit) {
  std::vector<std::string> ranges;
  for (const StabilityRange& range : fit.stability) ranges.push_back(stability_text(range));
  return join(ranges, "; ");
}

std::string fit_text(const FitReport& report) {
  const ShownUnit unit = shown_unit(report);
  std::string text;
  if (!report.description.title.empty()) text += one_line(report.description.title) + "\n";
  text += tests_line(report) + "\n" + objective_text(report) + "\n\n";
  std::vector<std::vector<std::string>> table = ranking(report, unit);
  table.front().emplace_back("stable");
  for (std::size_t i = 0; i < report.laws.size(); ++i) table[i + 1].push_back(stable_text(report.laws[i]));
  text += format_table(table);
  if (report.description.stability != StabilityRule::off)
    text += "\nStability is checked for stretches from 1/12 to 12; everywhere means this range.\n";
  for (const LawFit& fit : report.laws) add_law(fit, report, unit, text);
  for (const LawNotFitted& law : report.not_fitted)
    text += "\n" + law.name + " was not fitted: " + law.reason + "\n";
  return text;
}

std::string material_toml(const FitReport& report) {
  std::string text =
      "# " + objective_text(report) + ".\n# Tests: " + tests_line(report) +
      ".\n# To be pasted under a [[body]]; all laws but the first that a scene takes are commented out.\n";
  bool is_first = true;
  for (const LawFit& fit : report.laws) {
    const bool is_shown = is_first && fit.is_usable;
    text += "\n# " + fit.name + ": " +
            (std::isfinite(fit.aicc) ? "AICc " + format_short(fit.aicc) : "too few points for AICc") +
            ", E = " + format_short(fit.youngs_modulus) + " Pa at small strain.\n";
    if (fit.volume_is_assumed)
      text +=
          "# The tests tell nothing about changes of volume: a Poisson's ratio of " +
          format_number(report.description.poissons_ratio) + " is assumed; use " +
          (fit.material.law->has_volume_energy ? "element = \"P2P0\" or \"Q1P0\".\n" : "element = \"P2\".\n");
    for (const std::string& warning : fit.warnings) text += "# warning: " + one_line(warning) + "\n";
    text += std::string(is_shown ? "" : "# ") + "material = { law = \"" +
            std::string(fit.material.law->name) + "\"";
    for (std::size_t p = 0; p < fit.material.constants.size(); ++p)
      text += ", " + std::string(fit.material.law->constants[p].name) + " = " +
              format_number(fit.material.constants[p]);
    text += " }\n";
    is_first = is_first && !is_shown;
  }
  return text;
}

void make_fit_folder(const std::filesystem::path& folder) {
  std::error_code failure;
  std::filesystem::create_directories(folder, failure);
  if (failure) throw FileError(one_line(folder.string()), "cannot be made: " + failure.message());
}

void write_fit(const FitReport& report, const std::filesystem::path& folder) {
  make_fit_folder(folder);
  write_text(folder / "fit.json", fit_json_text(report));
  write_text(folder / "material.toml", material_toml(report));
  write_text(folder / "fit.html", fit_page(report));
}

}  // namespace resilin
