#pragma once

#include <string>
#include <vector>

#include "resilin/fit/scene_fit.hpp"

/// Common parts of the texts and the page of a fit of scenes.
namespace resilin {

/// "1.2" and "Pa" as "1.2 Pa"; the text alone without a unit.
std::string with_unit(const std::string& text, const std::string& unit);

/// "residuals over sigma, (model - measured) / sigma" ...
std::string objective_of(const SceneFitReport& report);

/// The parameters: name, value found, standard error, interval, start; the first row is the heading.
std::vector<std::vector<std::string>> parameter_rows(const SceneFitReport& report);

/// Misfit of each table; the first row is the heading.
std::vector<std::vector<std::string>> table_rows(const SceneFitReport& report);

/// The sum of squares and what it says about noise, in a line; whether the search has ended well, in another.
std::string quality_text(const SceneFitReport& report);
std::string search_text(const SceneFitReport& report);

}  // namespace resilin
