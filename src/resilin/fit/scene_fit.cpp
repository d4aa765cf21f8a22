#include "resilin/fit/scene_fit.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include "resilin/core/error.hpp"
#include "resilin/core/text.hpp"
#include "resilin/fit/scene_search.hpp"
#include "resilin/fit/search_starts.hpp"
#include "resilin/fit/uncertainty.hpp"

namespace resilin {
namespace {

/// Name of an unknown, with "log" where its logarithm is sought: a combination of logarithms is a product.
std::string sought_name(const SceneUnknown& unknown) {
  return unknown.is_positive ? "log " + unknown.name : unknown.name;
}

/// Standard errors, intervals and correlations at the end of the search.
void estimate_errors(const SceneModel& model, const LeastSquaresSearch& search, SceneFitReport& report) {
  const auto n = static_cast<Eigen::Index>(report.parameters.size());
  Eigen::Index num_held = 0;
  for (Eigen::Index i = 0; i < n; ++i) num_held += search.is_held(i) ? 1 : 0;
  DenseMatrix held = DenseMatrix::Zero(num_held, n);
  for (Eigen::Index i = 0, row = 0; i < n; ++i)
    if (search.is_held(i)) held(row++, i) = 1;
  report.degrees_of_freedom = report.num_values - static_cast<int>(n - num_held);
  const int degrees = report.degrees_of_freedom;
  std::vector<std::string>& warnings = report.estimates.warnings;
  double variance = degrees > 0 ? report.sum_of_squares / degrees : 0;
  double factor = degrees > 0 ? student_t_95(degrees) : 0;
  if (!report.has_sigma) report.noise = std::sqrt(variance);
  if (report.has_sigma) {
    const bool is_too_large = degrees > 0 && report.sum_of_squares > chi_square_99(degrees);
    if (is_too_large) {
      warnings.push_back(
          "model error: residuals are " + format_short(std::sqrt(variance)) +
          " times as large as the sigmas say. Mesh, element, law, boundary conditions or loads are not those "
          "of the experiment; intervals are widened by it, and yet the truth may lie outside them");
    } else {
      variance = 1;
      factor = normal_95;
    }
  } else if (degrees <= 0) {
    warnings.emplace_back("as many parameters as measured numbers: the fit says nothing about its errors");
  }
  for (const SceneUnknown& unknown : model.unknowns()) {
    ConstantEstimate estimate{sought_name(unknown), unknown.is_positive ? "" : unknown.unit};
    report.estimates.constants.push_back(estimate);
  }
  const Uncertainty uncertainty = uncertainty_of(search.slopes(), variance, held);
  tell_uncertainty(uncertainty, std::vector<double>(static_cast<std::size_t>(n), 1.0), factor,
                   report.estimates);
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto k = static_cast<std::size_t>(i);
    FittedParameter& parameter = report.parameters[k];
    ConstantEstimate& estimate = report.estimates.constants[k];
    parameter.is_held = search.is_held(i);
    if (parameter.is_held) estimate.standard_error = estimate.half_width_95 = 0;
    if (degrees <= 0 && !report.has_sigma && !parameter.is_held)
      estimate.standard_error = estimate.half_width_95 = std::numeric_limits<double>::infinity();
    const bool is_log = model.unknowns()[k].is_positive;
    const double half = estimate.half_width_95, value = parameter.value;
    parameter.standard_error = estimate.standard_error * search.transforms()[k].slope(search.z()[i]);
    parameter.lower_95 = is_log ? value * std::exp(-half) : value - half;
    parameter.upper_95 = is_log ? value * std::exp(half) : value + half;
    if (parameter.is_held)
      warnings.push_back(parameter.name + " is at its bound, " + format_number(value) +
                         ": the data would move it further");
  }
}

void judge_tables(const SceneModel& model, const VectorX& predicted, SceneFitReport& report) {
  const SceneData& data = model.data();
  for (const SceneData::Table& table : data.tables) {
    const VectorX off = (predicted - data.measured).segment(table.first, table.count);
    Eigen::Index worst = 0;
    const double largest = off.cwiseAbs().maxCoeff(&worst);
    TableQuality quality{
        .name = table.name,
        .kind = table.kind,
        .is_dynamic = report.description.experiments[table.experiment].description.is_dynamic,
        .root_mean_square = std::sqrt(off.squaredNorm() / static_cast<double>(table.count)),
        .largest = largest,
        .worst = data.places[static_cast<std::size_t>(table.first + worst)].row,
        .values = {}};
    for (Eigen::Index i = table.first; i < table.first + table.count; ++i)
      quality.values.push_back({data.places[static_cast<std::size_t>(i)], data.measured[i], predicted[i]});
    report.tables.push_back(std::move(quality));
  }
}

/// Those that are no cells of a field.
void list_parameters(const SceneModel& model, const VectorX& values, SceneFitReport& report) {
  for (std::size_t u = 0; u < model.unknowns().size(); ++u) {
    const SceneUnknown& unknown = model.unknowns()[u];
    if (model.ranges()[unknown.parameter].is_field) continue;
    report.parameters.push_back({.name = unknown.name,
                                 .key = report.description.parameters[unknown.parameter].key,
                                 .unit = unknown.unit,
                                 .start = unknown.start,
                                 .value = values[static_cast<Eigen::Index>(u)]});
  }
}

double objective_at(const SearchEnd& end, double strength) {
  return end.sum_of_squares + strength * end.roughness;
}

/// At one weight of the prior: the weights that searches for fields choose differ.
bool is_better(const SearchEnd& one, const SearchEnd& other) {
  const double strength = std::sqrt(one.strength * other.strength);
  return objective_at(one, strength) < objective_at(other, strength);
}

/// The search from many starts that has come to the best end.
std::unique_ptr<SceneSearch> search_from_many_starts(const SceneModel& model, const SceneFitOptions& options,
                                                     SceneFitReport& report) {
  const std::vector<SceneUnknown> sought = SceneSearch(model, report.description, options).sought();
  for (const SceneUnknown& unknown : sought) report.sought.push_back(unknown.name);
  std::unique_ptr<SceneSearch> best;
  for (const VectorX& start : search_starts(sought, report.description.starts)) {
    auto search = std::make_unique<SceneSearch>(model, report.description, options);
    SearchEnd end{.start = start, .found = start};
    try {
      search->run(start);
      end.found = search->sought_values();
      end.sum_of_squares = search->search().sum_of_squares();
      if (const FieldTerm* fields = search->fields()) {
        end.roughness = fields->roughness(search->search().z());
        end.strength = fields->strength();
      }
      end.is_converged = search->search().is_converged();
    } catch (const InputError& error) {
      if (!best) throw;  // an error in the file
      end.problem = error.what();
    }
    end.solves = search->search().evaluations();
    report.solves += end.solves;
    if (end.problem.empty() && (!best || is_better(end, report.ends[report.best_end]))) {
      best = std::move(search);
      report.best_end = report.ends.size();
    }
    report.ends.push_back(std::move(end));
  }
  const double strength = report.ends[report.best_end].strength;
  for (SearchEnd& end : report.ends) end.objective = objective_at(end, strength);
  return best;
}

}  // namespace

SceneFitReport fit_scenes(SceneFitDescription description, const SceneFitOptions& options) {
  SceneFitReport report;
  report.description = std::move(description);
  const SceneModel model(report.description);
  const SceneFitOptions noting{.on_solve =
                                   [&](const SceneFitStep& step) {
                                     report.steps.push_back(step);
                                     if (options.on_solve) options.on_solve(step);
                                   },
                               .goes_on = options.goes_on};
  const SceneData& data = model.data();
  report.has_sigma = data.sigma.size() > 0;
  report.num_values = static_cast<int>(data.measured.size());
  const std::unique_ptr<SceneSearch> best = search_from_many_starts(model, noting, report);
  const LeastSquaresSearch& search = best->search();
  const VectorX values = search.values();
  report.sum_of_squares = search.sum_of_squares();
  report.is_converged = search.is_converged();
  report.why_not = best->why_not();
  if (!report.is_converged)
    report.estimates.warnings.push_back("the search has not converged: " + report.why_not);
  list_parameters(model, values, report);
  for (std::string& other : model.other_elements(values))
    report.estimates.warnings.push_back(std::move(other));
  judge_tables(model, best->solved().values, report);
  for (std::size_t e = 0; e < report.description.experiments.size(); ++e)
    report.scenes.push_back(model.description_with(e, values));
  if (best->fields() != nullptr)
    tell_fields(model, *best, report);
  else
    estimate_errors(model, search, report);
  return report;
}

}  // namespace resilin
