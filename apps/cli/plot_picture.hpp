#pragma once

#include <string>
#include <vector>

#include "resilin/fit/plot_frame.hpp"
#include "resilin/picture/image.hpp"

namespace resilin::cli {

/// A curve of a plot; values that are no numbers leave a gap.
struct PlottedCurve {
  std::string label;
  Color color;
  std::vector<double> x, y;
};

/// A vertical line with a name on its left.
struct PlotMark {
  std::string name;
  double at = 0;
  bool has_line = true;
};

/// The pixels of a plot, as its SVG looks.
Image plot_image(const PlotFrame& frame, const std::string& title, const PlotAxis& x, const PlotAxis& y,
                 const std::vector<PlottedCurve>& curves, const std::vector<PlotMark>& marks);

}  // namespace resilin::cli
