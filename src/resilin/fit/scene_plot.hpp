#pragma once

#include <string>
#include <vector>

#include "resilin/fit/scene_fit.hpp"

/// Pictures of a fit of scenes, as SVG.
namespace resilin {

/// What the scenes give over what was measured, a colour for each component; on the dashed line they agree.
std::string agreement_plot(const TableQuality& table, const std::string& name);

/// Where markers have gone at the last moment, seen along the shortest of the axes; empty where a table has
/// no such.
std::string marker_plot(const TableQuality& table, const std::string& name);

/// What was measured and what the scenes give over load or time; empty for fewer than three moments.
std::string course_plot(const TableQuality& table, const std::string& name);

/// The sum of squares after each solve.
std::string search_plot(const std::vector<SceneFitStep>& steps);

}  // namespace resilin
