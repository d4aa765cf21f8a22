#include "resilin/fit/plot_frame.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "resilin/core/text.hpp"

namespace resilin {
namespace {

/// Round numbers: 1, 2 or 5 times a power of ten apart, about five of them.
std::vector<double> ticks_between(double low, double high) {
  const double rough = (high - low) / 5, power = std::pow(10, std::floor(std::log10(rough)));
  const double part = rough / power, step = power * (part < 1.5 ? 1 : part < 3.5 ? 2 : part < 7.5 ? 5 : 10);
  std::vector<double> ticks;
  for (double k = std::ceil(low / step); k * step <= high * (1 + 1e-12); ++k)
    ticks.push_back(k == 0 ? 0 : k * step);
  return ticks;
}

/// Powers of ten, about five of them; within two of them 1, 2 and 5 times such.
std::vector<double> powers_between(double low, double high) {
  const double first = std::log10(low), last = std::log10(high);
  std::vector<double> ticks;
  if (last - first < 2) {
    for (double k = std::floor(first); k <= last; ++k)
      for (const double part : {1, 2, 5})
        if (const double tick = part * std::pow(10, k); tick >= low && tick <= high) ticks.push_back(tick);
    return ticks;
  }
  const double step = std::max(1.0, std::round((last - first) / 5));
  for (double k = std::ceil(first / step); k * step <= last; ++k) ticks.push_back(std::pow(10, k * step));
  return ticks;
}

std::vector<double> ticks_of(const PlotAxis& axis) {
  return axis.is_logarithmic ? powers_between(axis.range.low, axis.range.high)
                             : ticks_between(axis.range.low, axis.range.high);
}

/// From 0 at the low end to 1 at the high one.
double share(const PlotAxis& axis, double value) {
  const PlotRange& range = axis.range;
  return axis.is_logarithmic ? std::log(value / range.low) / std::log(range.high / range.low)
                             : (value - range.low) / (range.high - range.low);
}

/// A range that can be drawn.
PlotRange drawable(const PlotAxis& axis) {
  const PlotRange& range = axis.range;
  if (!std::isfinite(range.low) || !std::isfinite(range.high)) return {axis.is_logarithmic ? 0.1 : 0, 1};
  if (!range.is_empty()) return range;
  if (axis.is_logarithmic) return {range.low / 2, range.low * 2};
  const double around = range.low == 0 ? 1 : std::abs(range.low) / 2;
  return {range.low - around, range.low + around};
}

}  // namespace

void PlotRange::include(double value) {
  if (!std::isfinite(value)) return;
  low = std::min(low, value);
  high = std::max(high, value);
}

PlotRange PlotRange::widened(double part) const {
  const double margin = part * (high - low);
  return {low - margin, high + margin};
}

PlotFrame::PlotFrame(std::string title, std::string name, PlotAxis x, PlotAxis y)
    : title_(std::move(title)), name_(std::move(name)), x_(std::move(x)), y_(std::move(y)) {
  x_.range = drawable(x_);
  y_.range = drawable(y_);
}

double PlotFrame::at_x(double value) const { return left + share(x_, value) * inner_width; }

double PlotFrame::at_y(double value) const {
  return std::clamp(height - bottom - share(y_, value) * inner_height, -1e4, 1e4);
}

std::vector<double> PlotFrame::ticks_x() const { return ticks_of(x_); }
std::vector<double> PlotFrame::ticks_y() const { return ticks_of(y_); }

double PlotFrame::base() const {
  const bool shows_zero = !y_.is_logarithmic && y_.range.low <= 0 && y_.range.high >= 0;
  return shows_zero ? at_y(0) : height - bottom;
}

std::string PlotFrame::open() const {
  return fmt::format(
      "<svg viewBox=\"0 0 {} {}\" role=\"img\" aria-label=\"{}\"><clipPath id=\"{}\"><rect x=\"{}\" y=\"{}\" "
      "width=\"{}\" height=\"{}\"/></clipPath>",
      width, height, html_text(title_), clip(), left, top, inner_width, inner_height);
}

std::string PlotFrame::axes() const {
  std::string text =
      fmt::format("<text class=\"title\" x=\"{}\" y=\"17\">{}</text>", left, html_text(title_));
  const double end = height - bottom;
  for (const double x : ticks_of(x_))
    text += fmt::format(
        "<line class=\"grid\" x1=\"{0:.2f}\" x2=\"{0:.2f}\" y1=\"{1}\" y2=\"{2}\"/><text x=\"{0:.2f}\" "
        "y=\"{3}\" text-anchor=\"middle\">{4}</text>",
        at_x(x), top, end, end + 14, format_short(x));
  for (const double y : ticks_of(y_))
    text += fmt::format(
        "<line class=\"grid\" x1=\"{0}\" x2=\"{1}\" y1=\"{2:.2f}\" y2=\"{2:.2f}\"/><text x=\"{3}\" "
        "y=\"{4:.2f}\" text-anchor=\"end\">{5}</text>",
        left, width - right, at_y(y), left - 5, at_y(y) + 4, format_short(y));
  text += fmt::format("<line class=\"axis\" x1=\"{0}\" x2=\"{1}\" y1=\"{2:.2f}\" y2=\"{2:.2f}\"/>", left,
                      width - right, base());
  return text + fmt::format(
                    "<text x=\"{0}\" y=\"{1}\" text-anchor=\"end\">{2}</text><text x=\"{0}\" y=\"17\" "
                    "text-anchor=\"end\">{3}</text>",
                    width - right, height - 5, html_text(x_.label), html_text(y_.label));
}

std::string PlotFrame::circle(double x, double y, std::string_view css_class, double radius) const {
  return fmt::format("<circle class=\"{}\" cx=\"{:.2f}\" cy=\"{:.2f}\" r=\"{}\"/>", css_class, at_x(x),
                     at_y(y), radius);
}

std::string PlotFrame::band(double from, double to, std::string_view css_class) const {
  return fmt::format("<rect class=\"{}\" x=\"{:.2f}\" y=\"{}\" width=\"{:.2f}\" height=\"{}\"/>", css_class,
                     at_x(from), top, at_x(to) - at_x(from), inner_height);
}

void make_alike(PlotRange& x, PlotRange& y) {
  const double metre =
      std::max((x.high - x.low) / PlotFrame::inner_width, (y.high - y.low) / PlotFrame::inner_height);
  const auto widen = [metre](PlotRange& range, double pixels) {
    const double middle = (range.low + range.high) / 2;
    range = {middle - metre * pixels / 2, middle + metre * pixels / 2};
  };
  widen(x, PlotFrame::inner_width);
  widen(y, PlotFrame::inner_height);
}

std::string html_text(std::string_view text) {
  std::string escaped;
  for (const char c : text) {
    if (c == '&')
      escaped += "&amp;";
    else if (c == '<')
      escaped += "&lt;";
    else if (c == '>')
      escaped += "&gt;";
    else if (c == '"')
      escaped += "&quot;";
    else
      escaped += c;
  }
  return escaped;
}

}  // namespace resilin
