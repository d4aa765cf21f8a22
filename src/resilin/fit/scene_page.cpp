#include <fmt/format.h>

#include <array>
#include <cmath>

#include "resilin/core/text.hpp"
#include "resilin/fit/field_output.hpp"
#include "resilin/fit/page_parts.hpp"
#include "resilin/fit/scene_fit_output.hpp"
#include "resilin/fit/scene_plot.hpp"

namespace resilin {
namespace {

/// Larger matrices of correlations are for fit.json.
constexpr std::size_t most_correlated = 12;

std::string component_legend(const SceneFitReport& report) {
  int most = 0;
  for (const TableQuality& table : report.tables)
    for (const FittedValue& value : table.values) most = std::max(most, value.of.component);
  std::string text = "<div class=\"legend\">";
  for (int i = 0; i <= most; ++i)
    text += fmt::format("<span><span class=\"swatch\" style=\"background: var(--s{})\"></span>{}</span>", i,
                        "xyz"[i]);
  return most == 0 ? "" : text + "</div>";
}

std::vector<std::string> pictures_of(const SceneFitReport& report) {
  std::vector<std::string> all;
  for (const FittedField& field : report.fields)
    if (const std::string picture = field_plot(report, field); !picture.empty()) all.push_back(picture);
  if (report.regularised) all.push_back(l_curve_plot(*report.regularised));
  for (std::size_t t = 0; t < report.tables.size(); ++t) {
    const TableQuality& table = report.tables[t];
    const std::string number = std::to_string(t);
    for (const std::string& picture :
         {marker_plot(table, "places-" + number), course_plot(table, "course-" + number),
          agreement_plot(table, "table-" + number)})
      if (!picture.empty()) all.push_back(picture);
  }
  all.push_back(search_plot(report.steps));
  return all;
}

std::string correlations_html(const SceneFitReport& report) {
  std::string text;
  for (const Correlation& pair : report.estimates.correlations) text += html_paragraph("faint", pair.text);
  const std::size_t n = report.estimates.constants.size();
  if (n < 2 || n > most_correlated || report.estimates.correlation_matrix.size() != n * n)
    return text.empty() ? html_paragraph("faint", "No two estimates are correlated above 0.95.") : text;
  std::vector<std::vector<std::string>> rows = {{""}};
  for (std::size_t i = 0; i < n; ++i) {
    rows.front().push_back(report.estimates.constants[i].name);
    rows.push_back({report.estimates.constants[i].name});
    for (std::size_t k = 0; k < n; ++k)
      rows.back().push_back(fmt::format("{:.3f}", report.estimates.correlation_matrix[i * n + k]));
  }
  return text + html_card(html_table(rows));
}

std::string fields_html(const SceneFitReport& report) {
  if (report.fields.empty()) return "";
  return html_heading("Fields, with intervals of 95 %") + html_card(html_table(field_rows(report))) +
         html_paragraph("faint",
                        regularisation_text(report) +
                            ". Values, intervals and resolution of each cell are in the files .vtu.");
}

std::string parameters_html(const SceneFitReport& report) {
  if (report.parameters.empty()) return "";
  std::string text =
      html_heading("Parameters, with intervals of 95 %") + html_card(html_table(parameter_rows(report)));
  if (report.fields.empty())
    text += html_heading("Correlations of the estimates") + correlations_html(report);
  return text;
}

std::string starts_html(const SceneFitReport& report) {
  if (report.ends.size() < 2) return "";
  std::vector<std::vector<std::string>> rows = {
      {"start", "solves", report.fields.empty() ? "sum of squares" : "sum of squares and prior"}};
  for (const std::string& name : report.sought) rows.front().push_back(name);
  for (std::size_t s = 0; s < report.ends.size(); ++s) {
    const SearchEnd& end = report.ends[s];
    rows.push_back(
        {std::to_string(s + 1), std::to_string(end.solves),
         std::isfinite(end.objective) ? fmt::format("{:.6g}", end.objective) : one_line(end.problem)});
    for (const double value : end.found) rows.back().push_back(fmt::format("{:.6g}", value));
  }
  return html_heading("Where each start has ended") + html_card(html_table(rows));
}

std::string search_html(const SceneFitReport& report) {
  std::vector<std::vector<std::string>> rows = {{"solve", "sum of squares"}};
  const std::vector<std::string>& names = report.steps.front().names;
  rows.front().insert(rows.front().end(), names.begin(), names.end());
  rows.front().emplace_back("");
  for (const SceneFitStep& step : report.steps) {
    rows.push_back({std::to_string(step.solve), std::isfinite(step.sum_of_squares)
                                                    ? fmt::format("{:.6g}", step.sum_of_squares)
                                                    : "no solution"});
    for (const double value : step.values) rows.back().push_back(fmt::format("{:.6g}", value));
    rows.back().push_back(step.is_better         ? ""
                          : step.problem.empty() ? "no better, a shorter step is tried"
                                                 : one_line(step.problem));
  }
  return html_card(html_table(rows));
}

}  // namespace

std::string scene_fit_page(const SceneFitReport& report) {
  const std::string& title = report.description.title;
  return html_page(
      {.title = title.empty() ? "Fit of scenes" : one_line(title),
       .objective = objective_of(report) + "; " + quality_text(report) + "; " + search_text(report),
       .warnings = report.estimates.warnings,
       .content = component_legend(report) + html_panels(pictures_of(report)) +
                  html_paragraph("faint",
                                 "Circles: what was measured. Dots and lines: what the scenes give with the "
                                 "parameters found. On the dashed line both are the same.") +
                  fields_html(report) + parameters_html(report) + html_heading("How well each table is met") +
                  html_card(html_table(table_rows(report))) + starts_html(report) +
                  html_heading("The search") + search_html(report) + html_heading("For a scene") +
                  html_paragraph("faint", "Also in material.toml.") +
                  html_listing(scene_material_toml(report))});
}

}  // namespace resilin
