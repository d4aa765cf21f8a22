#pragma once

#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "resilin/fit/fit_report.hpp"

/// What all fits write alike.
namespace resilin {

using FitJson = nlohmann::ordered_json;

/// What is infinite or no number is null.
FitJson number_json(double value);

FitJson correlations_json(const std::vector<Correlation>& correlations);

}  // namespace resilin
