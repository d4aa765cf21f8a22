#include "resilin/fit/fit_plot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "resilin/core/spelling.hpp"
#include "resilin/core/text.hpp"

namespace resilin {
namespace {

constexpr double plot_width = 380, plot_height = 270, plot_left = 52, plot_right = 10, plot_top = 28,
                 plot_bottom = 36;

/// Round numbers: 1, 2 or 5 times a power of ten apart, about five of them.
std::vector<double> ticks_between(double low, double high) {
  const double rough = (high - low) / 5, power = std::pow(10, std::floor(std::log10(rough)));
  const double part = rough / power, step = power * (part < 1.5 ? 1 : part < 3.5 ? 2 : part < 7.5 ? 5 : 10);
  std::vector<double> ticks;
  for (double k = std::ceil(low / step); k * step <= high * (1 + 1e-12); ++k) ticks.push_back(k * step);
  return ticks;
}

struct PlotRange {
  double low, high;
  void include(double value) {
    low = std::min(low, value);
    high = std::max(high, value);
  }
};

/// Draws one mode.
class Plot {
 public:
  Plot(const FitReport& report, TestMode mode) : report_(report), mode_(mode), unit_(shown_unit(report)) {
    const double rest = rest_load(mode);
    x_ = data_ = {rest, rest};
    y_ = {0, 0};
    for (const MaterialTest& test : report.description.tests) {
      if (test.mode != mode) continue;
      for (std::size_t i = 0; i < test.num_points(); ++i) {
        data_.include(test.load[i]);
        y_.include(test.stress[i] / unit_.in_pascal);
      }
    }
    is_tested_ = data_.low < data_.high;
    for (const LawFit& fit : report.laws) include_curve(curve_of(fit));
    if (!(y_.high - y_.low > 0) || !std::isfinite(y_.high - y_.low)) y_ = {0, 1};  // nothing to be seen
    const double margin = 0.06 * (y_.high - y_.low);
    y_ = {y_.low < 0 ? y_.low - margin : 0, y_.high + margin};
  }

  std::string svg() const {
    std::string text = fmt::format(
        "<svg viewBox=\"0 0 {} {}\" role=\"img\" aria-label=\"{}\"><clipPath id=\"clip-{}\"><rect x=\"{}\" "
        "y=\"{}\" "
        "width=\"{}\" height=\"{}\"/></clipPath>",
        plot_width, plot_height, spelling(mode_), spelling(mode_), plot_left, plot_top,
        plot_width - plot_left - plot_right, plot_height - plot_top - plot_bottom);
    if (is_tested_)
      text += fmt::format("<rect class=\"tested\" x=\"{:.2f}\" y=\"{}\" width=\"{:.2f}\" height=\"{}\"/>",
                          at_x(data_.low), plot_top, at_x(data_.high) - at_x(data_.low),
                          plot_height - plot_top - plot_bottom);
    text += axes();
    for (std::size_t i = 0; i < report_.laws.size(); ++i)
      if (const FittedCurve* curve = curve_of(report_.laws[i])) text += curve_path(*curve, i);
    return text + points() + "</svg>";
  }

 private:
  const FittedCurve* curve_of(const LawFit& fit) const {
    const auto found = std::ranges::find(fit.curves, mode_, &FittedCurve::mode);
    return found == fit.curves.end() ? nullptr : &*found;
  }

  /// Untested modes are shown by their curves; beyond data a curve may leave the picture.
  void include_curve(const FittedCurve* curve) {
    if (curve == nullptr) return;
    x_.include(curve->load.front());
    x_.include(curve->load.back());
    if (is_tested_) return;
    const bool is_best = curve == curve_of(report_.laws.front());
    for (const double stress : curve->stress)
      if (std::isfinite(stress) && is_best) y_.include(stress / unit_.in_pascal);
  }

  double at_x(double load) const {
    return plot_left + (load - x_.low) / (x_.high - x_.low) * (plot_width - plot_left - plot_right);
  }
  double at_y(double stress) const {
    const double y = plot_height - plot_bottom -
                     (stress - y_.low) / (y_.high - y_.low) * (plot_height - plot_top - plot_bottom);
    return std::clamp(y, -1e4, 1e4);
  }

  std::string axes() const {
    std::string text = fmt::format("<text class=\"title\" x=\"{}\" y=\"17\">{}{}</text>", plot_left,
                                   spelling(mode_), is_tested_ ? "" : " (no test: predicted)");
    const double bottom = plot_height - plot_bottom;
    for (const double x : ticks_between(x_.low, x_.high))
      text += fmt::format(
          "<line class=\"grid\" x1=\"{0:.2f}\" x2=\"{0:.2f}\" y1=\"{1}\" y2=\"{2}\"/><text x=\"{0:.2f}\" "
          "y=\"{3}\" "
          "text-anchor=\"middle\">{4}</text>",
          at_x(x), plot_top, bottom, bottom + 14, format_short(x));
    for (const double y : ticks_between(y_.low, y_.high))
      text += fmt::format(
          "<line class=\"grid\" x1=\"{0}\" x2=\"{1}\" y1=\"{2:.2f}\" y2=\"{2:.2f}\"/><text x=\"{3}\" "
          "y=\"{4:.2f}\" "
          "text-anchor=\"end\">{5}</text>",
          plot_left, plot_width - plot_right, at_y(y), plot_left - 5, at_y(y) + 4, format_short(y));
    text += fmt::format("<line class=\"axis\" x1=\"{0}\" x2=\"{1}\" y1=\"{2:.2f}\" y2=\"{2:.2f}\"/>",
                        plot_left, plot_width - plot_right, at_y(0));
    text += fmt::format("<text x=\"{}\" y=\"{}\" text-anchor=\"end\">{}</text>", plot_width - plot_right,
                        plot_height - 5, mode_ == TestMode::simple_shear ? "amount of shear" : "stretch");
    return text + fmt::format("<text x=\"{}\" y=\"17\" text-anchor=\"end\">nominal stress [{}]</text>",
                              plot_width - plot_right, html_text(unit_.name));
  }

  /// Pieces in turn solid and dashed; those that leave the picture above end there.
  std::string curve_path(const FittedCurve& curve, std::size_t law) const {
    std::string text, piece;
    bool is_piece_stable = true;
    const auto end_piece = [&] {
      if (piece.find('L') != std::string::npos)
        text += fmt::format(
            "<path class=\"law-{}{}\" clip-path=\"url(#clip-{})\" stroke=\"var(--s{})\" d=\"{}\"/>", law,
            is_piece_stable ? "" : " unstable", spelling(mode_), law % num_plot_colours, piece);
      piece.clear();
    };
    for (std::size_t i = 0; i < curve.load.size(); ++i) {
      if (!std::isfinite(curve.stress[i])) {
        end_piece();
        continue;
      }
      const std::string place =
          fmt::format("{:.2f} {:.2f}", at_x(curve.load[i]), at_y(curve.stress[i] / unit_.in_pascal));
      if (!piece.empty() && curve.is_stable[i] != is_piece_stable) {
        piece += "L" + place;
        end_piece();
      }
      if (piece.empty()) is_piece_stable = curve.is_stable[i];
      piece += (piece.empty() ? "M" : "L") + place;
    }
    end_piece();
    return text;
  }

  std::string points() const {
    std::string text;
    for (const MaterialTest& test : report_.description.tests)
      for (std::size_t i = 0; i < test.num_points() && test.mode == mode_; ++i)
        text += fmt::format("<circle class=\"point\" cx=\"{:.2f}\" cy=\"{:.2f}\" r=\"2.7\"/>",
                            at_x(test.load[i]), at_y(test.stress[i] / unit_.in_pascal));
    return text;
  }

  const FitReport& report_;
  TestMode mode_;
  ShownUnit unit_;
  PlotRange x_, y_, data_;
  bool is_tested_ = false;
};

}  // namespace

std::string fit_plot(const FitReport& report, TestMode mode) { return Plot(report, mode).svg(); }

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
