#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "resilin/picture/image.hpp"

namespace resilin {

/// From values to colours.
struct ColorScale {
  double low = 0, high = 1;
  std::string map = "viridis";
  double least = 0, greatest = 0;  ///< least and greatest of the values themselves

  /// Values outside the range take the colours of its ends.
  double place(double value) const { return (value - low) / (high - low); }
};

/// @param values  those that are not finite are passed over
/// @param range   by default that of the values, for a diverging map as far on both sides of zero
/// @param smallest  width of the range; values that differ less are the same up to rounding
/// @param map     a colour map, or "auto": diverging when the range has zero inside
ColorScale choose_scale(std::span<const double> values, const std::optional<std::array<double, 2>>& range,
                        const std::string& map, double smallest = 0);

/// Text at a colour bar.
struct ScaleText {
  struct Tick {
    double place;  ///< from 0 at the lower end of the bar to 1
    std::string text;
  };
  std::string title;  ///< "von Mises stress [kPa]"
  std::vector<Tick> ticks;
  std::string extremes;  ///< "min 0.61   max 8.61"
};

/// Round numbers with a factor of a thousand in the unit (kPa) or, without unit, in the title.
/// @param unit  "Pa", "m", "J/m^3"; may be empty
ScaleText scale_text(const ColorScale& scale, const std::string& label, const std::string& unit);

}  // namespace resilin
