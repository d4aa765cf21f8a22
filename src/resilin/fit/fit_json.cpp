#include "resilin/fit/fit_json.hpp"

#include <cmath>
#include <nlohmann/json.hpp>

#include "resilin/core/spelling.hpp"
#include "resilin/fit/fit_output.hpp"

namespace resilin {
namespace {

FitJson numbers_json(const std::vector<double>& values) {
  FitJson list = FitJson::array();
  for (const double value : values) list.push_back(number_json(value));
  return list;
}

FitJson optional_json(const std::optional<double>& value) {
  return value ? FitJson(*value) : FitJson(nullptr);
}

FitJson constants_json(const LawFit& fit) {
  FitJson list = FitJson::array();
  for (const ConstantEstimate& constant : fit.constants)
    list.push_back({{"name", constant.name},
                    {"unit", constant.unit},
                    {"value", number_json(constant.value)},
                    {"standard_error", number_json(constant.standard_error)},
                    {"half_width_95", number_json(constant.half_width_95)},
                    {"origin", spelling(constant.origin)},
                    {"is_determined", constant.is_determined}});
  return list;
}

FitJson law_fit_json(const LawFit& fit) {
  FitJson json = {{"name", fit.name},
                  {"law", fit.material.law->name},
                  {"formula", fit.material.law->formula},
                  {"constants", constants_json(fit)},
                  {"volume_is_assumed", fit.volume_is_assumed},
                  {"sum_of_squares", number_json(fit.sum_of_squares)},
                  {"points", fit.num_points},
                  {"fitted", fit.num_fitted},
                  {"aicc", number_json(fit.aicc)},
                  {"akaike_weight", fit.akaike_weight},
                  {"condition", number_json(fit.condition)},
                  {"correlation_matrix", numbers_json(fit.correlation_matrix)},
                  {"correlations", correlations_json(fit.correlations)},
                  {"tests", FitJson::array()},
                  {"stability", FitJson::array()},
                  {"curves", FitJson::array()},
                  {"shear_modulus", number_json(fit.shear_modulus)},
                  {"bulk_modulus", number_json(fit.bulk_modulus)},
                  {"youngs_modulus", number_json(fit.youngs_modulus)},
                  {"poissons_ratio", number_json(fit.poissons_ratio)},
                  {"is_bounded", fit.is_bounded},
                  {"free_sum_of_squares", optional_json(fit.free_sum_of_squares)},
                  {"remarks", fit.remarks},
                  {"warnings", fit.warnings}};
  for (const TestQuality& test : fit.tests)
    json["tests"].push_back({{"test", test.test},
                             {"r_squared", number_json(test.r_squared)},
                             {"root_mean_square", number_json(test.root_mean_square)},
                             {"largest", number_json(test.largest)}});
  for (const StabilityRange& range : fit.stability)
    json["stability"].push_back({{"mode", spelling(range.mode)},
                                 {"unstable_below", optional_json(range.below)},
                                 {"unstable_above", optional_json(range.above)}});
  for (const FittedCurve& curve : fit.curves)
    json["curves"].push_back({{"mode", spelling(curve.mode)},
                              {"load", numbers_json(curve.load)},
                              {"nominal_stress", numbers_json(curve.stress)},
                              {"is_stable", curve.is_stable}});
  return json;
}

FitJson test_json(const MaterialTest& test) {
  return {{"name", test.name}, {"mode", spelling(test.mode)},   {"unit", test.unit},  {"weight", test.weight},
          {"load", test.load}, {"nominal_stress", test.stress}, {"sigma", test.sigma}};
}

}  // namespace

FitJson number_json(double value) { return std::isfinite(value) ? FitJson(value) : FitJson(nullptr); }

FitJson correlations_json(const std::vector<Correlation>& correlations) {
  FitJson list = FitJson::array();
  for (const Correlation& pair : correlations)
    list.push_back(
        {{"first", pair.first}, {"second", pair.second}, {"value", pair.value}, {"text", pair.text}});
  return list;
}

std::string fit_json_text(const FitReport& report) {
  FitJson json = {{"title", report.description.title},
                  {"objective", objective_text(report)},
                  {"residual", spelling(report.description.residual)},
                  {"stability", spelling(report.description.stability)},
                  {"compressible", report.is_compressible},
                  {"units",
                   {{"stress", "Pa"},
                    {"sum_of_squares", report.description.residual == ResidualKind::absolute ? "Pa^2" : ""}}},
                  {"tests", FitJson::array()},
                  {"laws", FitJson::array()},
                  {"not_fitted", FitJson::array()},
                  {"warnings", report.warnings}};
  for (const MaterialTest& test : report.description.tests) json["tests"].push_back(test_json(test));
  for (const LawFit& fit : report.laws) json["laws"].push_back(law_fit_json(fit));
  for (const LawNotFitted& law : report.not_fitted)
    json["not_fitted"].push_back({{"name", law.name}, {"reason", law.reason}});
  return json.dump(1, ' ', false, FitJson::error_handler_t::replace) + "\n";
}

}  // namespace resilin
