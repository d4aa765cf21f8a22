#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <ostream>
#include <set>

#include "resilin/core/error.hpp"
#include "resilin/core/spelling.hpp"
#include "resilin/core/text.hpp"
#include "resilin/fit/field_output.hpp"
#include "resilin/fit/fit_json.hpp"
#include "resilin/fit/fit_output.hpp"
#include "resilin/fit/scene_fit_output.hpp"
#include "resilin/io/atomic_file.hpp"
#include "resilin/material/law_sum.hpp"

namespace resilin {
namespace {

/// Ends of searches that differ by less are one; of fields, whose weights differ a little, too.
constexpr double same_sum = 1e-3, same_sum_of_fields = 1e-2;

/// So many digits as an interval of this half width makes known.
std::string rounded_text(double value, double half_width) {
  const double size = std::max(std::abs(value), std::abs(half_width));
  if (!(half_width > 0) || !std::isfinite(half_width) || size >= 1e9 || half_width < 1e-6)
    return value_text(value, half_width);
  const int decimals = 1 - static_cast<int>(std::floor(std::log10(half_width)));
  const double step = std::pow(10, -decimals);
  return fmt::format("{:.{}f}", std::round(value / step) * step, std::max(decimals, 0));
}

/// The one unit that the values have; empty where they have not.
std::string common_unit(const SceneFitReport& report) {
  return report.has_sigma || report.tables.empty() ? "" : unit_of(report.tables.front().kind);
}

std::vector<std::string> parameter_row(const FittedParameter& parameter) {
  const double half = (parameter.upper_95 - parameter.lower_95) / 2;
  const std::string value = with_unit(rounded_text(parameter.value, half), parameter.unit);
  if (parameter.is_held) return {parameter.name, value, "-", "at a bound", format_number(parameter.start)};
  if (!std::isfinite(parameter.standard_error))
    return {parameter.name, value, "-", "not determined", format_number(parameter.start)};
  return {parameter.name, value, rounded_text(parameter.standard_error, parameter.standard_error),
          rounded_text(parameter.lower_95, half) + " to " + rounded_text(parameter.upper_95, half),
          format_number(parameter.start)};
}

std::string cell_file_name(const std::string& body, const std::string& constant) {
  return field_file_stem(body, constant) + ".csv";
}

/// Among the keys that are sought, the constants of the material of this body, or of a region
/// "BODY.region.NAME".
std::vector<std::string> sought_constants(const SceneFitReport& report, const std::string& owner) {
  std::vector<std::string> constants;
  const std::string begin = "body." + owner + ".material.";
  for (const SceneParameter& parameter : report.description.parameters)
    if (parameter.key.starts_with(begin)) constants.push_back(parameter.key.substr(begin.size()));
  return constants;
}

/// "material = { ... }" of a scene, with files for lists by cell of this body.
std::string material_line(const MaterialDescription& material, const std::string& body) {
  // The keys of the material, or of one part of a sum: they begin with `prefix`.
  const auto table = [&](const std::string& law, const std::string& prefix) {
    std::string text = "law = \"" + law + "\"";
    for (const auto& [name, value] : material.constants)
      if (name.starts_with(prefix)) text += ", " + name.substr(prefix.size()) + " = " + format_number(value);
    for (const auto& [name, values] : material.cell_constants)
      if (name.starts_with(prefix))
        text += ", " + name.substr(prefix.size()) + " = { file = \"" + cell_file_name(body, name) + "\" }";
    return text;
  };
  std::string text = "material = { ";
  const LawInfo& law = require_law(material.law, material.place + ".law");
  if (is_sum(law)) {
    for (std::size_t i = 0; i < law.parts.size(); ++i)
      text.append(i == 0 ? "sum = [{ " : ", { ")
          .append(table(std::string(law.parts[i]->name), sum_constant(i, "")))
          .append(" }");
    text += "]";
  } else {
    text += table(material.law, "");
  }
  return text + ", density = " + format_number(material.density) +
         (material.fibres.empty() ? "" : ", fibres = ... as in the scene") + " }\n";
}

/// Calls `use(body)` for each body of the scenes whose material is sought, once.
template <class Use>
void for_each_fitted_body(const SceneFitReport& report, const Use& use) {
  std::set<std::string> done;
  for (const Description& scene : report.scenes)
    for (const BodyDescription& body : scene.bodies)
      if (!sought_constants(report, body.name).empty() && done.insert(body.name).second) use(body);
}

}  // namespace

std::string scene_fit_step_text(const SceneFitStep& step) {
  std::string text = "solve " + std::to_string(step.solve) + ": ";
  text += std::isfinite(step.sum_of_squares) ? "sum of squares " + fmt::format("{:.6g}", step.sum_of_squares)
                                             : "no solution";
  for (std::size_t i = 0; i < step.names.size(); ++i)
    text += ", " + step.names[i] + " " + fmt::format("{:.6g}", step.values[static_cast<Eigen::Index>(i)]);
  if (!step.problem.empty())
    text += " (" + step.problem + "); a shorter step is tried";
  else if (!step.is_better)
    text += "; no better, a shorter step is tried";
  return one_line(text);
}

std::string with_unit(const std::string& text, const std::string& unit) {
  return unit.empty() ? text : text + " " + unit;
}

std::string objective_of(const SceneFitReport& report) {
  return report.has_sigma ? "residuals over sigma, (model - measured) / sigma"
                          : "absolute residuals, model - measured";
}

std::vector<std::vector<std::string>> parameter_rows(const SceneFitReport& report) {
  std::vector<std::vector<std::string>> rows = {
      {"parameter", "found", "standard error", "interval", "start"}};
  for (const FittedParameter& parameter : report.parameters) rows.push_back(parameter_row(parameter));
  return rows;
}

std::vector<std::vector<std::string>> table_rows(const SceneFitReport& report) {
  std::vector<std::vector<std::string>> rows = {
      {"measured", "numbers", "root mean square off", "most", "where"}};
  for (const TableQuality& table : report.tables)
    rows.push_back({table.name, std::to_string(table.values.size()),
                    with_unit(format_short(table.root_mean_square), unit_of(table.kind)),
                    with_unit(format_short(table.largest), unit_of(table.kind)), table.worst});
  return rows;
}

std::string quality_text(const SceneFitReport& report) {
  const std::string unit = common_unit(report);
  std::string text = "sum of squares " +
                     with_unit(fmt::format("{:.6g}", report.sum_of_squares), unit.empty() ? "" : unit + "^2");
  if (report.degrees_of_freedom > 0)
    text += report.has_sigma
                ? ", per degree of freedom (" + std::to_string(report.degrees_of_freedom) + ") " +
                      format_short(report.sum_of_squares / report.degrees_of_freedom) + " (1 is noise alone)"
                : "; noise of " + with_unit(format_short(report.noise), unit) + " by the residuals";
  return text;
}

namespace {

/// How many of several starts ended where the best one did.
std::string starts_text(const SceneFitReport& report) {
  if (report.ends.size() < 2) return "";
  const bool has_fields = !report.fields.empty();
  const double reached = report.ends[report.best_end].objective;
  const double near = (has_fields ? same_sum_of_fields : same_sum) * reached;
  int same = 0, others = 0, without = 0;
  for (const SearchEnd& end : report.ends) {
    const bool is_same = std::abs(end.objective - reached) <= near;
    ++(!std::isfinite(end.objective) ? without : is_same ? same : others);
  }
  std::string text = "; " + std::to_string(same) + " of " + std::to_string(report.ends.size()) +
                     (has_fields ? " starts ended with this sum of squares and prior"
                                 : " starts ended with this sum of squares");
  if (others > 0) text += ", " + std::to_string(others) + (has_fields ? " elsewhere" : " with larger ones");
  if (without > 0) text += ", " + std::to_string(without) + " had no solution";
  return text;
}

}  // namespace

std::string search_text(const SceneFitReport& report) {
  return std::string(report.is_converged ? "converged" : "not converged") + " after " +
         std::to_string(report.solves) + " solves" +
         (report.scenes.size() > 1 ? " of each of the " + std::to_string(report.scenes.size()) + " scenes"
                                   : "") +
         starts_text(report);
}

std::string scene_fit_text(const SceneFitReport& report) {
  std::string text;
  if (!report.description.title.empty()) text += one_line(report.description.title) + "\n";
  text += objective_of(report) + "; intervals of 95 %\n\n";
  if (!report.parameters.empty()) text += format_table(parameter_rows(report)) + "\n";
  if (!report.fields.empty()) text += format_table(field_rows(report)) + "\n";
  text += format_table(table_rows(report)) + "\n" + quality_text(report) + "\n";
  if (report.regularised) text += regularisation_text(report) + "\n";
  text += search_text(report) + "\n";
  for (const Correlation& pair : report.estimates.correlations) text += pair.text + "\n";
  return text;
}

namespace {

void add_fields(const SceneFitReport& report, FitJson& json) {
  json["starts"] = FitJson::array();
  for (const SearchEnd& end : report.ends)
    json["starts"].push_back({{"start", std::vector<double>(end.start.begin(), end.start.end())},
                              {"found", std::vector<double>(end.found.begin(), end.found.end())},
                              {"sum_of_squares", number_json(end.sum_of_squares)},
                              {"objective", number_json(end.objective)},
                              {"solves", end.solves},
                              {"is_converged", end.is_converged}});
  json["fields"] = FitJson::array();
  const auto numbers = [](const std::vector<double>& values) {
    FitJson all = FitJson::array();
    for (const double value : values) all.push_back(number_json(value));
    return all;
  };
  for (const FittedField& field : report.fields)
    json["fields"].push_back({{"name", field.name},
                              {"key", field.key},
                              {"unit", field.unit},
                              {"values", numbers(field.values)},
                              {"lower_95", numbers(field.lower_95)},
                              {"upper_95", numbers(field.upper_95)},
                              {"resolution", numbers(field.resolution)},
                              {"loose_cells", field.num_loose}});
  if (!report.regularised) return;
  const RegularisationReport& told = *report.regularised;
  FitJson curve = FitJson::array();
  for (const RegularisedProblem::Point& point : told.curve.points)
    curve.push_back({{"strength", point.strength},
                     {"sum_of_squares", point.misfit},
                     {"roughness", point.roughness},
                     {"freedom", point.freedom},
                     {"curvature", number_json(point.curvature)}});
  json["regularise"] = {{"kind", spelling(told.asked.kind)},
                        {"strength", told.strength},
                        {"corner", told.curve.corner},
                        {"discrepancy", told.discrepancy},
                        {"cross_validated", told.cross_validated},
                        {"roughness", told.point.roughness},
                        {"freedom", told.point.freedom},
                        {"l_curve", curve}};
}

}  // namespace

std::string scene_fit_json_text(const SceneFitReport& report) {
  FitJson json = {{"title", report.description.title},
                  {"objective", objective_of(report)},
                  {"parameters", FitJson::array()},
                  {"sum_of_squares", number_json(report.sum_of_squares)},
                  {"has_sigma", report.has_sigma},
                  {"values", report.num_values},
                  {"degrees_of_freedom", report.degrees_of_freedom},
                  {"solves", report.solves},
                  {"is_converged", report.is_converged},
                  {"condition", number_json(report.estimates.condition)},
                  {"correlation_matrix", report.estimates.correlation_matrix},
                  {"correlations", correlations_json(report.estimates.correlations)},
                  {"tables", FitJson::array()},
                  {"warnings", report.estimates.warnings}};
  for (const FittedParameter& parameter : report.parameters)
    json["parameters"].push_back({{"name", parameter.name},
                                  {"key", parameter.key},
                                  {"unit", parameter.unit},
                                  {"start", parameter.start},
                                  {"value", parameter.value},
                                  {"standard_error", number_json(parameter.standard_error)},
                                  {"lower_95", number_json(parameter.lower_95)},
                                  {"upper_95", number_json(parameter.upper_95)},
                                  {"is_held", parameter.is_held}});
  add_fields(report, json);
  for (const TableQuality& table : report.tables) {
    std::vector<double> measured, model;
    for (const FittedValue& value : table.values) {
      measured.push_back(value.measured);
      model.push_back(value.model);
    }
    json["tables"].push_back({{"name", table.name},
                              {"kind", spelling(table.kind)},
                              {"unit", unit_of(table.kind)},
                              {"root_mean_square", table.root_mean_square},
                              {"largest", table.largest},
                              {"measured", measured},
                              {"model", model}});
  }
  return json.dump(1, ' ', false, FitJson::error_handler_t::replace) + "\n";
}

std::string scene_material_toml(const SceneFitReport& report) {
  std::string text = "# " + objective_of(report) + ".\n";
  for (const FittedParameter& parameter : report.parameters)
    text +=
        one_line("# " + parameter.name + " = " + with_unit(format_number(parameter.value), parameter.unit) +
                 (parameter.is_held                         ? ", at a bound"
                  : std::isfinite(parameter.standard_error) ? ", 95 %: " + parameter_row(parameter)[3]
                                                            : ", not determined")) +
        "\n";
  if (report.regularised) text += "# " + regularisation_text(report) + ".\n";
  for (const std::string& warning : report.estimates.warnings)
    text += "# warning: " + one_line(warning) + "\n";
  for_each_fitted_body(report, [&](const BodyDescription& body) {
    text +=
        "\n# Under the [[body]] \"" + one_line(body.name) + "\":\n" + material_line(body.material, body.name);
  });
  std::set<std::string> done;
  for (const Description& scene : report.scenes)
    for (const BodyDescription& body : scene.bodies)
      for (const RegionDescription& region : body.regions) {
        const std::string owner = body.name + ".region." + region.name;
        if (sought_constants(report, owner).empty() || !done.insert(owner).second) continue;
        text += "\n# Under the [[body.region]] \"" + one_line(region.name) + "\" of \"" +
                one_line(body.name) + "\":\n" + material_line(region.material, body.name);
      }
  return text;
}

void write_scene_fit(const SceneFitReport& report, const std::filesystem::path& folder) {
  make_fit_folder(folder);
  write_text(folder / "fit.json", scene_fit_json_text(report));
  write_text(folder / "fit.html", scene_fit_page(report));
  write_text(folder / "material.toml", scene_material_toml(report));
  for (const FittedField& field : report.fields)
    write_field(report, field, folder / (field_file_stem(field.body, field.constant) + ".vtu"));
  for_each_fitted_body(report, [&](const BodyDescription& body) {
    for (const auto& [name, values] : body.material.cell_constants) {
      std::string rows;
      for (const double value : values) rows += format_number(value) + "\n";
      write_text(folder / cell_file_name(body.name, name), rows);
    }
  });
}

}  // namespace resilin
