#include <fmt/format.h>

#include <cmath>
#include <map>

#include "resilin/core/spelling.hpp"
#include "resilin/core/text.hpp"
#include "resilin/fit/fit_output.hpp"
#include "resilin/fit/fit_page_bytes.hpp"
#include "resilin/fit/fit_plot.hpp"

namespace resilin {
namespace {

std::string html_table(const std::vector<std::vector<std::string>>& rows) {
  std::string text = "<table>";
  for (std::size_t i = 0; i < rows.size(); ++i) {
    text += "<tr>";
    for (const std::string& cell : rows[i])
      text += (i == 0 ? "<th>" : "<td>") + html_text(cell) + (i == 0 ? "</th>" : "</td>");
    text += "</tr>";
  }
  return text + "</table>";
}

std::string legend_html(const FitReport& report) {
  std::string text;
  for (std::size_t i = 0; i < report.laws.size(); ++i)
    text += fmt::format(
        "<label><input type=\"checkbox\" value=\"{}\" checked><span class=\"swatch\" style=\"background: "
        "var(--s{})\"></span>{}"
        "</label>",
        i, i % num_plot_colours, html_text(report.laws[i].name));
  return text;
}

std::string ranking_html(const FitReport& report) {
  const ShownUnit unit = shown_unit(report);
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
  return html_table(rows);
}

std::string constants_html(const LawFit& fit, const ShownUnit& unit) {
  std::vector<std::vector<std::string>> rows = {{"constant", "value", "95 % interval", "unit"}};
  for (const ConstantEstimate& constant : fit.constants) {
    const double scale = constant.unit.empty() ? 1 : unit.in_pascal;
    const double value = constant.value / scale, half = constant.half_width_95 / scale;
    const std::string interval =
        !constant.is_fitted() ? spelling(constant.origin)
        : constant.is_determined && std::isfinite(half)
            ? value_text(value - half, half) + " to " + value_text(value + half, half)
            : "not determined";
    rows.push_back(
        {constant.name, value_text(value, half), interval, constant.unit.empty() ? "" : unit.name});
  }
  return html_table(rows);
}

std::string paragraph(const std::string& kind, const std::string& text) {
  return "<p class=\"" + kind + "\">" + html_text(text) + "</p>";
}

std::string law_html(const LawFit& fit, const ShownUnit& unit) {
  std::string text = "<h2>" + html_text(fit.name) + "</h2>" +
                     paragraph("faint", "Psi = " + std::string(fit.material.law->formula)) +
                     "<div class=\"card\">" + constants_html(fit, unit) + "</div>";
  std::string stable;
  for (const StabilityRange& range : fit.stability)
    stable += (stable.empty() ? "" : "; ") + stability_text(range);
  if (!stable.empty()) text += paragraph("faint", "Stable: " + stable);
  for (const Correlation& pair : fit.correlations) text += paragraph("faint", pair.text);
  for (const std::string& remark : fit.remarks) text += paragraph("faint", remark);
  for (const std::string& warning : fit.warnings) text += paragraph("warning", warning);
  return text;
}

/// The template with each {{name}} replaced.
std::string filled(std::string_view page, const std::map<std::string, std::string, std::less<>>& parts) {
  std::string text;
  while (true) {
    const std::size_t open = page.find("{{"), close = page.find("}}", open);
    text += page.substr(0, open);
    if (open == std::string_view::npos) return text;
    text += parts.at(std::string(page.substr(open + 2, close - open - 2)));
    page.remove_prefix(close + 2);
  }
}

}  // namespace

std::string fit_page(const FitReport& report) {
  const ShownUnit unit = shown_unit(report);
  std::string panels, laws, warnings;
  for (const FittedCurve& curve : report.laws.front().curves)
    panels += "<div class=\"card\">" + fit_plot(report, curve.mode) + "</div>";
  for (const LawFit& fit : report.laws) laws += law_html(fit, unit);
  for (const std::string& warning : report.warnings) warnings += paragraph("warning", warning);
  for (const LawNotFitted& law : report.not_fitted)
    warnings += paragraph("warning", law.name + " was not fitted: " + law.reason);
  const std::span<const unsigned char> bytes = fit_page_bytes();
  const std::string title =
      report.description.title.empty() ? "Fit of a material" : one_line(report.description.title);
  return filled({reinterpret_cast<const char*>(bytes.data()), bytes.size()},
                {{"title", html_text(title)},
                 {"objective", html_text(objective_text(report))},
                 {"warnings", warnings},
                 {"legend", legend_html(report)},
                 {"panels", panels},
                 {"ranking", ranking_html(report)},
                 {"laws", laws},
                 {"material", html_text(material_toml(report))}});
}

}  // namespace resilin
