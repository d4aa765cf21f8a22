#pragma once

#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "resilin/fit/fit_report.hpp"

/// Common JSON of all fits.
namespace resilin {

/// JSON whose keys keep their order.
using FitJson = nlohmann::ordered_json;

/// Infinite numbers and NaN are null.
FitJson number_json(double value);

/// Pairs of strongly correlated estimates as a list of objects.
FitJson correlations_json(const std::vector<Correlation>& correlations);

}  // namespace resilin
