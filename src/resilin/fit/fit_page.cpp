#include <fmt/format.h>

#include <cmath>

#include "resilin/core/spelling.hpp"
#include "resilin/core/text.hpp"
#include "resilin/fit/fit_output.hpp"
#include "resilin/fit/fit_plot.hpp"
#include "resilin/fit/page_parts.hpp"
#include "resilin/fit/plot_frame.hpp"

namespace resilin {
namespace {

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

std::string law_html(const LawFit& fit, const ShownUnit& unit) {
  std::string text = html_heading(fit.name) +
                     html_paragraph("faint", "Psi = " + std::string(fit.material.law->formula)) +
                     "<div class=\"card\">" + constants_html(fit, unit) + "</div>";
  if (!fit.stability.empty()) text += html_paragraph("faint", "Stable: " + stability_text(fit));
  for (const Correlation& pair : fit.correlations) text += html_paragraph("faint", pair.text);
  for (const std::string& remark : fit.remarks) text += html_paragraph("faint", remark);
  for (const std::string& warning : fit.warnings) text += html_paragraph("warning", warning);
  return text;
}

}  // namespace

std::string fit_page(const FitReport& report) {
  const ShownUnit unit = shown_unit(report);
  std::vector<std::string> panels, warnings = report.warnings;
  for (const FittedCurve& curve : report.laws.front().curves) panels.push_back(fit_plot(report, curve.mode));
  for (const LawNotFitted& law : report.not_fitted)
    warnings.push_back(law.name + " was not fitted: " + law.reason);
  std::string laws;
  for (const LawFit& fit : report.laws) laws += law_html(fit, unit);
  return html_page(
      {.title = report.description.title.empty() ? "Fit of a material" : one_line(report.description.title),
       .objective = objective_text(report),
       .warnings = warnings,
       .content =
           "<div class=\"legend\">" + legend_html(report) + "</div>" + html_panels(panels) +
           html_paragraph("faint",
                          "Circles: data. The shaded range is that of the data. Lines are dashed where "
                          "the model is unstable (Drucker's condition).") +
           html_heading("Models, the best first") + html_card(html_table(ranking(report, unit))) + laws +
           html_heading("For a scene") +
           html_paragraph("faint", "Also in material.toml: to be pasted under a [[body]].") +
           html_listing(material_toml(report))});
}

}  // namespace resilin
