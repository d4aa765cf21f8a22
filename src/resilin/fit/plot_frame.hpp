#pragma once

#include <limits>
#include <string>
#include <string_view>
#include <vector>

/// Common parts of the pictures of a report.
namespace resilin {

/// An interval of what is drawn.
struct PlotRange {
  double low = std::numeric_limits<double>::infinity(), high = -low;

  void include(double value);  ///< ignores values that are not finite
  bool is_empty() const { return !(low < high); }
  /// By a part of its length at both ends, so that nothing is drawn on the edge.
  PlotRange widened(double part) const;
};

/// A direction of a picture.
struct PlotAxis {
  std::string label;
  PlotRange range;              ///< range of the values, also where their logarithms are drawn
  bool is_logarithmic = false;  ///< all values are positive
};

/// Axes with round numbers, and where values lie between them. An SVG of 380 x 270 that grows with its card.
class PlotFrame {
 public:
  /// @param name  one word, of this picture alone on its page
  PlotFrame(std::string title, std::string name, PlotAxis x, PlotAxis y);

  double at_x(double value) const;
  double at_y(double value) const;  ///< far outside: somewhere outside

  std::vector<double> ticks_x() const;
  std::vector<double> ticks_y() const;
  double base() const;  ///< height of the horizontal axis: at zero where that is seen, else at the bottom

  std::string open() const;  ///< <svg ...>, and the clip path `clip()`
  std::string axes() const;
  std::string clip() const { return "clip-" + name_; }
  std::string circle(double x, double y, std::string_view css_class, double radius) const;
  /// A rectangle over the whole height between two values.
  std::string band(double from, double to, std::string_view css_class) const;

  static constexpr double width = 380, height = 270, left = 52, right = 10, top = 28, bottom = 36;
  static constexpr double inner_width = width - left - right, inner_height = height - top - bottom;

 private:
  std::string title_, name_;
  PlotAxis x_, y_;
};

/// Widens two ranges so that a picture shows both at one scale, and a circle stays one.
void make_alike(PlotRange& x, PlotRange& y);

/// The text with &, <, > and quotation marks written for HTML.
std::string html_text(std::string_view text);

/// Colours "var(--s0)", "var(--s1)" ... repeat after so many.
constexpr std::size_t num_plot_colours = 8;

}  // namespace resilin
