#pragma once

#include <vector>

#include "resilin/picture/color_scale.hpp"
#include "resilin/picture/text.hpp"

namespace resilin {

/// Draws the title in the upper right corner, the bar with its ticks below it and the extremes under the bar.
/// Where values lie beyond an end, that end is pointed.
void draw_color_bar(Image& image, const ColorScale& scale, const ScaleText& text, const TextPen& pen,
                    Color ink);

/// The room that it takes from the right side of a picture [pixels].
double color_bar_width(const ScaleText& text, const TextPen& pen);

/// A rectangle of a picture, y downwards [pixels].
struct PictureBox {
  double left = 0, top = 0, right = 0, bottom = 0;
};

/// Boxes around the words and the bar that `draw_color_bar` draws, which lines leave free.
std::vector<PictureBox> color_bar_boxes(int width, int height, const ScaleText& text, const TextPen& pen);

}  // namespace resilin
