#include "plot_picture.hpp"

#include <cmath>

#include "resilin/core/text.hpp"
#include "resilin/picture/canvas.hpp"
#include "resilin/picture/text.hpp"

namespace resilin::cli {
namespace {

constexpr double pixels = 2.5;  ///< for each unit of the frame
constexpr Color paper = {255, 255, 255}, grid = {221, 221, 221}, axis = {85, 85, 85}, ink = {51, 51, 51},
                pale = {119, 119, 119};

Vector3 place(double x, double y) { return {pixels * x, pixels * y, 0}; }

void draw_curve(const PlotFrame& frame, const PlottedCurve& curve, Canvas& canvas) {
  for (std::size_t i = 1; i < curve.x.size(); ++i) {
    const double ends[] = {curve.x[i - 1], curve.y[i - 1], curve.x[i], curve.y[i]};
    bool is_drawn = true;
    for (const double end : ends) is_drawn = is_drawn && std::isfinite(end);
    if (is_drawn)
      canvas.line(place(frame.at_x(ends[0]), frame.at_y(ends[1])),
                  place(frame.at_x(ends[2]), frame.at_y(ends[3])), 1.8 * pixels, 1, {curve.color, 1});
  }
}

}  // namespace

Image plot_image(const PlotFrame& frame, const std::string& title, const PlotAxis& x, const PlotAxis& y,
                 const std::vector<PlottedCurve>& curves, const std::vector<PlotMark>& marks) {
  using F = PlotFrame;
  const double end = F::height - F::bottom, right = F::width - F::right;
  Canvas canvas(static_cast<int>(pixels * F::width), static_cast<int>(pixels * F::height), paper);
  for (const double tick : frame.ticks_x())
    canvas.line(place(frame.at_x(tick), F::top), place(frame.at_x(tick), end), pixels, 0, {grid, 1});
  for (const double tick : frame.ticks_y())
    canvas.line(place(F::left, frame.at_y(tick)), place(right, frame.at_y(tick)), pixels, 0, {grid, 1});
  canvas.line(place(F::left, frame.base()), place(right, frame.base()), pixels, 0, {axis, 1});
  for (const PlotMark& mark : marks)
    if (mark.has_line)
      canvas.line(place(frame.at_x(mark.at), F::top), place(frame.at_x(mark.at), end), pixels, 0,
                  {pale, 0.6});
  for (const PlottedCurve& curve : curves) draw_curve(frame, curve, canvas);
  Image image = canvas.image();
  const TextPen pen(11 * pixels);
  const auto write = [&](double at, double base, const std::string& text, Color color, double share_left) {
    pen.draw(image, pixels * at - share_left * pen.width(text), pixels * base, text, color);
  };
  write(F::left, 17, title, ink, 0);
  write(right, 17, y.label, ink, 1);
  write(right, F::height - 5, x.label, ink, 1);
  for (const double tick : frame.ticks_x()) write(frame.at_x(tick), end + 14, format_short(tick), ink, 0.5);
  for (const double tick : frame.ticks_y())
    write(F::left - 5, frame.at_y(tick) + 4, format_short(tick), ink, 1);
  for (const PlotMark& mark : marks) write(frame.at_x(mark.at) - 3, end - 4, mark.name, pale, 1);
  for (std::size_t i = 0; i < curves.size(); ++i)
    write(F::left + 6, F::top + 12 + 13 * static_cast<double>(i), curves[i].label, curves[i].color, 0);
  return image;
}

}  // namespace resilin::cli
