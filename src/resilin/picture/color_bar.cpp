#include "resilin/picture/color_bar.hpp"

#include <algorithm>
#include <cmath>

#include "resilin/picture/color_map.hpp"

namespace resilin {
namespace {

void fill(Image& image, int left, int top, int right, int bottom, Color color) {
  for (int y = std::max(top, 0); y < std::min(bottom, image.height); ++y)
    for (int x = std::max(left, 0); x < std::min(right, image.width); ++x) image.at(x, y) = color;
}

double widest_tick(const ScaleText& text, const TextPen& pen) {
  double widest = 0;
  for (const ScaleText::Tick& tick : text.ticks) widest = std::max(widest, pen.width(tick.text));
  return widest;
}

}  // namespace

double color_bar_width(const ScaleText& text, const TextPen& pen) {
  return widest_tick(text, pen) + 6 * pen.digit_height();
}

void draw_color_bar(Image& image, const ColorScale& scale, const ScaleText& text, const TextPen& pen,
                    Color ink) {
  const double em = pen.digit_height();
  const int margin = static_cast<int>(1.5 * em), tick_length = static_cast<int>(std::ceil(em / 3));
  const int right =
      image.width - margin - static_cast<int>(std::ceil(widest_tick(text, pen) + 0.7 * em)) - tick_length;
  const int left = right - static_cast<int>(1.6 * em);
  const int top = static_cast<int>(0.17 * image.height), bottom = static_cast<int>(0.83 * image.height);
  for (int y = top; y < bottom; ++y) {
    const double t = 1 - (y + 0.5 - top) / (bottom - top);
    fill(image, left, y, right, y + 1, map_color(scale.map, t));
  }
  fill(image, left - 1, top - 1, right + 1, top, ink);
  fill(image, left - 1, bottom, right + 1, bottom + 1, ink);
  fill(image, left - 1, top, left, bottom, ink);
  fill(image, right, top, right + 1, bottom, ink);
  // Points beyond the ends where there are values that the bar has no colour for.
  const double tip = 0.9 * em, middle = 0.5 * (left + right);
  const auto point = [&](double base, double direction, Color color) {
    for (int row = 0; row < static_cast<int>(tip); ++row) {
      const double half = 0.5 * (right - left) * (1 - (row + 0.5) / tip);
      const int y = static_cast<int>(base + direction * row) - (direction < 0 ? 1 : 0);
      fill(image, static_cast<int>(std::lround(middle - half)), y,
           static_cast<int>(std::lround(middle + half)), y + 1, color);
    }
  };
  if (scale.greatest > scale.high) point(top - 2, -1, map_color(scale.map, 1));
  if (scale.least < scale.low) point(bottom + 2, 1, map_color(scale.map, 0));
  for (const ScaleText::Tick& tick : text.ticks) {
    const double y = bottom - tick.place * (bottom - top);
    const int row = std::clamp(static_cast<int>(std::floor(y)), top, bottom - 1);
    fill(image, right, row, right + 1 + tick_length, row + 1, ink);
    pen.draw(image, right + 1 + tick_length + 0.5 * em, y + em / 2, tick.text, ink);
  }
  const double end = image.width - margin;
  pen.draw(image, std::max(0.0, end - pen.width(text.title)), top - 2.2 * em, text.title, ink);
  pen.draw(image, std::max(0.0, end - pen.width(text.extremes)), bottom + 2.8 * em, text.extremes, ink);
}

}  // namespace resilin
