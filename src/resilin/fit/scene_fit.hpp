#pragma once

#include <filesystem>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "resilin/fit/fit_report.hpp"
#include "resilin/fit/regularised_problem.hpp"
#include "resilin/fit/scene_model.hpp"

namespace resilin {

/// The scenes have been solved once more.
struct SceneFitStep {
  int solve = 0;  ///< from 1
  std::vector<std::string> names{};
  VectorX values{};  ///< values of the parameters
  double sum_of_squares =
      0;                  ///< sum of squares of weighted residuals; infinite where a scene has no solution
  bool is_better = true;  ///< better than the solution before
  std::string problem{};  ///< why there is no solution
};

/// A measured number beside what the scenes give.
struct FittedValue {
  MeasuredPlace of;
  double measured = 0, model = 0;
};

/// Fit of the scenes to one table of measurements.
struct TableQuality {
  std::string name;
  MeasuredKind kind;
  bool is_dynamic = false;          ///< moments are times, else load factors
  double root_mean_square = 0;      ///< root mean square of model - measured, in the unit of its kind
  double largest = 0;               ///< likewise ...
  std::string worst;                ///< ... in this row
  std::vector<FittedValue> values;  ///< component by component of each row
};

/// One parameter, with its interval: by the logarithm where that was sought.
struct FittedParameter {
  std::string name, key, unit;
  double start = 0, value = 0;
  double standard_error = 0;          ///< infinite: not determined
  double lower_95 = 0, upper_95 = 0;  ///< ends of the interval of 95 %
  bool is_held = false;               ///< by a bound
};

/// Result of the search from one start.
struct SearchEnd {
  VectorX start, found;  ///< all unknowns; of a field its middle, the mean of what is sought
  double sum_of_squares = std::numeric_limits<double>::infinity();
  double roughness = 0,
         strength = 0;  ///< roughness and strength of fields: u^T R u of the prior, and its weight
  /// The sum of squares, and of fields the prior with the weight of the best end.
  double objective = std::numeric_limits<double>::infinity();
  int solves = 0;
  bool is_converged = false;
  std::string problem{};  ///< why there is no end
};

/// A constant of each cell, found.
struct FittedField {
  std::string name, key, unit;
  std::string body, constant;
  std::size_t scene = 0;         ///< the number of one that has it
  std::vector<double> values{};  ///< values of the cells
  std::vector<double> lower_95{},
      upper_95{};  ///< ends of the intervals of 95 %: of noise and of what the prior leaves open
  std::vector<double> resolution{};  ///< over about such a length the data tell a mean [m]
  int num_loose = 0;                 ///< cells whose interval is wider than a factor of 2 to both sides
};

/// Choice of the weight of the fields' prior.
struct RegularisationReport {
  Regularisation asked;
  LCurve curve;                       ///< at the place found
  double strength = 0;                ///< weight taken
  double discrepancy = 0;             ///< weight by the discrepancy principle; 0: none, or no sigmas
  double cross_validated = 0;         ///< weight by generalised cross validation
  RegularisedProblem::Point point{};  ///< at the weight taken
};

/// Result of a fit of scenes.
struct SceneFitReport {
  SceneFitDescription description;
  std::vector<FittedParameter> parameters;  ///< those that are no cells of a field
  Estimates estimates;  ///< estimates of parameters that no bound holds: correlations, condition, warnings
  bool has_sigma = false;
  double sum_of_squares =
      0;             ///< sum of squares of residuals over sigma, where there are sigmas [m^2 or N^2 else]
  double noise = 0;  ///< standard deviation that the residuals show, without sigmas [m or N]
  int num_values = 0, degrees_of_freedom = 0;
  int solves = 0;  ///< solves of each scene, of all starts
  bool is_converged = false;
  std::string why_not;              ///< converged
  std::vector<SceneFitStep> steps;  ///< steps of the search, one start after another
  std::vector<SearchEnd> ends;      ///< ends of each start
  std::size_t best_end = 0;         ///< the number of the one that counts
  std::vector<std::string> sought;  ///< names of the numbers of a start
  std::vector<FittedField> fields;
  std::optional<RegularisationReport> regularised;  ///< where there are fields
  std::vector<TableQuality> tables;
  std::vector<Description> scenes;  ///< with the parameters found
};

/// Callbacks of a fit of scenes.
struct SceneFitOptions {
  std::function<void(const SceneFitStep&)> on_solve{};
  std::function<bool()> goes_on{};  ///< false: Interrupted is thrown
};

/// Finds parameters of scenes from what was measured: least squares by Levenberg and Marquardt with exact
/// slopes, in logarithms of what is positive.
///
/// Each iterate is solved as its scene says, from the start; slopes are tangent solves with its factors.
/// @throws InputError   for data and parameters that do not fit each other, such as a parameter that no datum
///                      feels
/// @throws Interrupted
SceneFitReport fit_scenes(SceneFitDescription description, const SceneFitOptions& options = {});

/// Parameters, intervals, how well each table is met, and what is to be said.
std::string scene_fit_text(const SceneFitReport& report);
std::string scene_fit_step_text(const SceneFitStep& step);  ///< one line

/// Everything, with all digits; SI. What is infinite is null.
std::string scene_fit_json_text(const SceneFitReport& report);

/// The materials found, to be pasted under their [[body]], and the other parameters.
std::string scene_material_toml(const SceneFitReport& report);

/// One page, without a network: what was measured beside what the scenes give, parameters, the search.
std::string scene_fit_page(const SceneFitReport& report);

/// fit.html, fit.json and material.toml, and a table of cell values where a constant has them; each written
/// beside and renamed.
void write_scene_fit(const SceneFitReport& report, const std::filesystem::path& folder);

}  // namespace resilin
