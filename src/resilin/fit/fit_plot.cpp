#include "resilin/fit/fit_plot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "resilin/core/spelling.hpp"
#include "resilin/fit/plot_frame.hpp"

namespace resilin {
namespace {

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
    const PlotFrame frame(spelling(mode_) + (is_tested_ ? "" : " (no test: predicted)"), spelling(mode_),
                          {mode_ == TestMode::simple_shear ? "amount of shear" : "stretch", x_},
                          {"nominal stress [" + unit_.name + "]", y_});
    std::string text = frame.open();
    if (is_tested_) text += frame.band(data_.low, data_.high, "tested");
    text += frame.axes();
    for (std::size_t i = 0; i < report_.laws.size(); ++i)
      if (const FittedCurve* curve = curve_of(report_.laws[i])) text += curve_path(frame, *curve, i);
    return text + points(frame) + "</svg>";
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

  /// Pieces in turn solid and dashed; those that leave the picture above end there.
  std::string curve_path(const PlotFrame& frame, const FittedCurve& curve, std::size_t law) const {
    std::string text, piece;
    bool is_piece_stable = true;
    const auto end_piece = [&] {
      if (piece.find('L') != std::string::npos)
        text +=
            fmt::format("<path class=\"law-{}{}\" clip-path=\"url(#{})\" stroke=\"var(--s{})\" d=\"{}\"/>",
                        law, is_piece_stable ? "" : " unstable", frame.clip(), law % num_plot_colours, piece);
      piece.clear();
    };
    for (std::size_t i = 0; i < curve.load.size(); ++i) {
      if (!std::isfinite(curve.stress[i])) {
        end_piece();
        continue;
      }
      const std::string place = fmt::format("{:.2f} {:.2f}", frame.at_x(curve.load[i]),
                                            frame.at_y(curve.stress[i] / unit_.in_pascal));
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

  std::string points(const PlotFrame& frame) const {
    std::string text;
    for (const MaterialTest& test : report_.description.tests)
      for (std::size_t i = 0; i < test.num_points() && test.mode == mode_; ++i)
        text += frame.circle(test.load[i], test.stress[i] / unit_.in_pascal, "point", 2.7);
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

}  // namespace resilin
