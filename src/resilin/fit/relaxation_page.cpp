// The page of a Prony series: data, the curve and the table.
#include <fmt/format.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "resilin/core/text.hpp"
#include "resilin/fit/page_parts.hpp"
#include "resilin/fit/plot_frame.hpp"
#include "resilin/fit/relaxation_fit.hpp"

namespace resilin {
namespace {

using ModulusAt = std::function<double(double)>;

/// E(t), or the storage or loss modulus at a frequency.
ModulusAt relaxation_modulus(const RelaxationFit& fit) {
  return [&fit](double time) {
    double modulus = fit.long_term;
    for (std::size_t k = 0; k < fit.tau.size(); ++k) modulus += fit.parts[k] * std::exp(-time / fit.tau[k]);
    return modulus;
  };
}
ModulusAt dynamic_modulus(const RelaxationFit& fit, bool is_storage) {
  return [&fit, is_storage](double frequency) {
    double modulus = is_storage ? fit.long_term : 0;
    for (std::size_t k = 0; k < fit.tau.size(); ++k) {
      const double x = 2 * std::numbers::pi * frequency * fit.tau[k];
      modulus += fit.parts[k] * (is_storage ? x * x : x) / (1 + x * x);
    }
    return modulus;
  };
}

/// Data as circles and the series as a line over a logarithmic axis, on which a time of 0 is left out.
std::string modulus_plot(const std::string& title, const std::string& name, const std::string& axis,
                         const std::vector<double>& at, const std::vector<double>& values,
                         const ModulusAt& modulus) {
  PlotRange x, y;
  y.include(0);
  for (std::size_t i = 0; i < at.size(); ++i) {
    if (at[i] > 0) x.include(at[i]);
    y.include(values[i]);
  }
  if (x.is_empty()) x = {0.5 * x.low, 2 * x.low};  // one point
  std::vector<std::pair<double, double>> line;
  constexpr int count = 200;
  for (int i = 0; i <= count; ++i) {
    const double place = x.low * std::pow(x.high / x.low, static_cast<double>(i) / count);
    line.emplace_back(place, modulus(place));
    y.include(line.back().second);
  }
  const double margin = 0.06 * (y.high - y.low);
  const PlotFrame frame(title, name, {axis, x, /*is_logarithmic=*/true},
                        {"modulus, in the unit of the data", {y.low, y.high + margin}});
  std::string path;
  for (const auto& [place, value] : line)
    path += fmt::format("{}{:.2f} {:.2f}", path.empty() ? "M" : "L", frame.at_x(place), frame.at_y(value));
  std::string text =
      frame.open() + frame.axes() +
      fmt::format("<path class=\"line\" clip-path=\"url(#{})\" d=\"{}\"/>", frame.clip(), path);
  for (std::size_t i = 0; i < at.size(); ++i)
    if (at[i] > 0) text += frame.circle(at[i], values[i], "point", 2.7);
  return text + "</svg>";
}

}  // namespace

std::string relaxation_page(const RelaxationFit& fit) {
  const RelaxationDescription& d = fit.description;
  std::vector<std::string> panels;
  if (!d.times.empty())
    panels.push_back(modulus_plot("relaxation under held strain", "relaxation", "time [s]", d.times, d.moduli,
                                  relaxation_modulus(fit)));
  else
    panels = {modulus_plot("storage modulus", "storage", "frequency [Hz]", d.frequencies, d.storage,
                           dynamic_modulus(fit, true)),
              modulus_plot("loss modulus", "loss", "frequency [Hz]", d.frequencies, d.loss,
                           dynamic_modulus(fit, false))};
  std::vector<std::vector<std::string>> rows = {
      {"relaxation time tau [s]", "share g, instantaneous", "share g, long-term"}};
  const std::vector<double> sudden = fit.shares(), slow = fit.shares(/*of_long_term=*/true);
  for (std::size_t k = 0; k < sudden.size(); ++k)
    rows.push_back({format_short(fit.tau[k]), format_short(sudden[k]), format_short(slow[k])});
  return html_page(
      {.title = d.title.empty() ? "Fit of a relaxation" : one_line(d.title),
       .objective = relaxation_errors_text(fit),
       .warnings = {},
       .content = html_panels(panels) + html_paragraph("faint", "Circles: data. Line: the Prony series.") +
                  html_heading("Prony series") + html_card(html_table(rows)) +
                  html_paragraph("faint", "Modulus under a sudden load: " +
                                              format_short(fit.instantaneous()) + ", after a long time: " +
                                              format_short(fit.long_term) + ", in the unit of the data.") +
                  html_heading("For a scene") +
                  html_paragraph("faint", "Also in material.toml: a line of the material of a [[body]].") +
                  html_listing(relaxation_toml(fit))});
}

}  // namespace resilin
