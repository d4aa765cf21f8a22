#pragma once

#include "resilin/picture/color_scale.hpp"
#include "resilin/picture/text.hpp"

namespace resilin {

/// Draws the title in the upper right corner, the bar with its ticks below it and the extremes under the bar.
/// Where values lie beyond an end, that end is pointed.
void draw_color_bar(Image& image, const ColorScale& scale, const ScaleText& text, const TextPen& pen,
                    Color ink);

/// The room that it takes from the right side of a picture [pixels].
double color_bar_width(const ScaleText& text, const TextPen& pen);

}  // namespace resilin
