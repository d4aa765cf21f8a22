#pragma once

#include <string>
#include <string_view>

#include "resilin/fit/fit_output.hpp"

namespace resilin {

/// Data and curves of one mode as SVG, a path of class "law-N" for each law.
std::string fit_plot(const FitReport& report, TestMode mode);

/// The text with &, <, > and quotation marks written for HTML.
std::string html_text(std::string_view text);

/// Colours repeat after so many laws.
constexpr std::size_t num_plot_colours = 8;

}  // namespace resilin
