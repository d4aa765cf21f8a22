#pragma once

#include <string>

#include "resilin/fit/fit_output.hpp"

namespace resilin {

/// Data and curves of one mode as SVG, a path of class "law-N" for each law.
std::string fit_plot(const FitReport& report, TestMode mode);

}  // namespace resilin
