#pragma once

#include <string>
#include <vector>

#include "resilin/fit/scene_fit.hpp"

/// Pictures of a fit of scenes, as SVG.
namespace resilin {

/// Values of the scenes over the measured ones, a colour for each component; on the dashed line they agree.
std::string agreement_plot(const TableQuality& table, const std::string& name);

/// Final positions of markers, seen along the shortest of the axes; empty where a table has no such.
std::string marker_plot(const TableQuality& table, const std::string& name);

/// Measured values and values of the scenes over load or time; empty for fewer than three moments.
std::string course_plot(const TableQuality& table, const std::string& name);

/// The sum of squares after each solve.
std::string search_plot(const std::vector<SceneFitStep>& steps);

}  // namespace resilin
