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

/// Place of the bar itself, and where its words end [pixels].
struct BarPlace {
  int left, top, right, bottom, tick_length;
  double end;
};

BarPlace place_of_bar(int width, int height, const ScaleText& text, const TextPen& pen) {
  const double em = pen.digit_height();
  const int margin = static_cast<int>(1.5 * em), tick_length = static_cast<int>(std::ceil(em / 3));
  const int right =
      width - margin - static_cast<int>(std::ceil(widest_tick(text, pen) + 0.7 * em)) - tick_length;
  return {.left = right - static_cast<int>(1.6 * em),
          .top = static_cast<int>(0.17 * height),
          .right = right,
          .bottom = static_cast<int>(0.83 * height),
          .tick_length = tick_length,
          .end = static_cast<double>(width - margin)};
}

/// Baselines of the title and of the extremes, relative to the bar in heights of a digit.
constexpr double title_above = 2.2, extremes_below = 2.8;

}  // namespace

std::vector<PictureBox> color_bar_boxes(int width, int height, const ScaleText& text, const TextPen& pen) {
  const double em = pen.digit_height();
  const BarPlace bar = place_of_bar(width, height, text, pen);
  const auto around_words = [&](const std::string& words, double baseline) -> PictureBox {
    return {bar.end - pen.width(words) - 0.7 * em, baseline - 1.8 * em, static_cast<double>(width),
            baseline + em};
  };
  return {around_words(text.title, bar.top - title_above * em),
          {bar.left - 0.7 * em, bar.top - em, static_cast<double>(width), bar.bottom + em},
          around_words(text.extremes, bar.bottom + extremes_below * em)};
}

double color_bar_width(const ScaleText& text, const TextPen& pen) {
  return widest_tick(text, pen) + 6 * pen.digit_height();
}

void draw_color_bar(Image& image, const ColorScale& scale, const ScaleText& text, const TextPen& pen,
                    Color ink) {
  const double em = pen.digit_height();
  const auto [left, top, right, bottom, tick_length, end] =
      place_of_bar(image.width, image.height, text, pen);
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
  pen.draw(image, std::max(0.0, end - pen.width(text.title)), top - title_above * em, text.title, ink);
  pen.draw(image, std::max(0.0, end - pen.width(text.extremes)), bottom + extremes_below * em, text.extremes,
           ink);
}

}  // namespace resilin
