#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "resilin/fit/fit_report.hpp"

/// Output of a fit.
namespace resilin {

/// A table of the laws, the best first, and what is to be said about each. Stresses in the unit of the tests.
std::string fit_text(const FitReport& report);

/// Everything, with all digits; SI. What is infinite or not determined is null.
std::string fit_json_text(const FitReport& report);

/// material = { ... } of the best law, to be pasted under a [[body]]; the other laws as comments.
std::string material_toml(const FitReport& report);

/// One page, without a network: curves with data, dashed where unstable, and the table.
std::string fit_page(const FitReport& report);

/// With those above it. Throws FileError.
void make_fit_folder(const std::filesystem::path& folder);

/// fit.json, fit.html and material.toml, each written beside and renamed.
void write_fit(const FitReport& report, const std::filesystem::path& folder);

/// Unit in which stresses are shown: that of most tests.
struct ShownUnit {
  std::string name;
  double in_pascal;
};
ShownUnit shown_unit(const FitReport& report);

/// The laws as rows, the best first, below the names of the columns.
std::vector<std::vector<std::string>> ranking(const FitReport& report, const ShownUnit& unit);

/// "0.35264", "7.28e-07": so many digits as the interval makes known.
std::string value_text(double value, double half_width);

/// "absolute residuals P_model - P_measured" ..., and the weights.
std::string objective_text(const FitReport& report);

/// "uniaxial: stable", "equibiaxial: 0.283 to 8.85".
std::string stability_text(const StabilityRange& range);
/// Those of a law, "; " between them; empty where it was not checked.
std::string stability_text(const LawFit& fit);

}  // namespace resilin
