#pragma once

#include <optional>
#include <string>

#include "resilin/material/derive.hpp"

namespace resilin::cli {

/// Options of `resilin materials LAW --curve ...`.
struct CurveOptions {
  std::string load_case;       ///< empty: no curve
  std::optional<double> from;  ///< stretches, or amounts of shear; default: usual_range
  std::optional<double> to;
  int points = 16;
  std::string csv;  ///< a file; empty: none
};

/// Prints the curve as a table or as JSON, writes the file, and warns of lost stability.
void print_curve(const Material& material, const CurveOptions& options, bool json);

}  // namespace resilin::cli
