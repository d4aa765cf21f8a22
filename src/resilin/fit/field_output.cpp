#include "resilin/fit/field_output.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "resilin/core/spelling.hpp"
#include "resilin/core/text.hpp"
#include "resilin/fit/plot_frame.hpp"
#include "resilin/fit/scene_fit_output.hpp"
#include "resilin/io/vtu.hpp"
#include "resilin/picture/color_map.hpp"
#include "resilin/world/body_mesh.hpp"

namespace resilin {
namespace {

constexpr std::size_t most_drawn_cells = 20'000;

double at_share(std::vector<double> values, double share) {
  const auto place = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::ranges::nth_element(values, values.begin() + place);
  return values[static_cast<std::size_t>(place)];
}

const BodyDescription& body_of(const SceneFitReport& report, const FittedField& field) {
  return *std::ranges::find(report.scenes[field.scene].bodies, field.body, &BodyDescription::name);
}

std::string how_chosen(const RegularisationReport& regularised) {
  if (regularised.asked.strength) return "as given";
  if (regularised.asked.rule == StrengthRule::discrepancy) return "by the discrepancy principle";
  return regularised.curve.corner > 0 ? "by the corner of the L-curve" : "by cross validation";
}

}  // namespace

std::vector<std::vector<std::string>> field_rows(const SceneFitReport& report) {
  std::vector<std::vector<std::string>> rows = {{"field", "cells", "found",
                                                 "intervals, half of the cells better than",
                                                 "resolution, half better than"}};
  for (const FittedField& field : report.fields) {
    std::vector<double> widths;
    const bool is_ratio = *std::ranges::min_element(field.lower_95) > 0;
    for (std::size_t c = 0; c < field.values.size(); ++c)
      widths.push_back(is_ratio ? std::sqrt(field.upper_95[c] / field.lower_95[c])
                                : (field.upper_95[c] - field.lower_95[c]) / 2);
    const double width = at_share(widths, 0.5);
    rows.push_back({field.name, std::to_string(field.values.size()),
                    with_unit(fmt::format("{:.4g} to {:.4g}", std::ranges::min(field.values),
                                          std::ranges::max(field.values)),
                              field.unit),
                    is_ratio ? fmt::format("times or over {:.3g}", width)
                             : with_unit(fmt::format("plus or minus {:.3g}", width), field.unit),
                    fmt::format("{:.3g} m", at_share(field.resolution, 0.5))});
  }
  return rows;
}

std::string regularisation_text(const SceneFitReport& report) {
  if (!report.regularised) return "";
  const RegularisationReport& told = *report.regularised;
  std::size_t cells = 0;
  for (const FittedField& field : report.fields) cells += field.values.size();
  std::string text = "prior " + spelling(told.asked.kind) + ", weight " + format_short(told.strength) + " " +
                     how_chosen(told) + " (";
  if (told.curve.corner > 0 && (told.asked.strength || told.asked.rule == StrengthRule::discrepancy))
    text += "the L-curve has its corner at " + format_short(told.curve.corner) + ", ";
  if (report.has_sigma)
    text += told.discrepancy > 0 ? "the discrepancy principle takes " + format_short(told.discrepancy)
                                 : "no weight leaves so small a misfit as the sigmas say";
  else
    text += "cross validation takes " + format_short(told.cross_validated);
  return text + "); of " + std::to_string(cells + report.parameters.size()) +
         " unknowns the data determine some " + fmt::format("{:.0f}", told.point.freedom) + " combinations";
}

std::string l_curve_plot(const RegularisationReport& regularised) {
  PlotRange x, y;
  for (const RegularisedProblem::Point& point : regularised.curve.points) {
    x.include(point.misfit);
    y.include(point.roughness);
  }
  x.include(regularised.point.misfit);
  y.include(regularised.point.roughness);
  if (!(x.low > 0) || !(y.low > 0)) return "";
  x = {x.low / 1.3, x.high * 1.3};
  y = {y.low / 1.5, y.high * 1.5};
  const PlotFrame frame("the L-curve", "l-curve", {"sum of squares", x, true}, {"roughness", y, true});
  std::string line;
  for (const RegularisedProblem::Point& point : regularised.curve.points)
    line += fmt::format("{}{:.2f} {:.2f}", line.empty() ? "M" : "L", frame.at_x(point.misfit),
                        frame.at_y(point.roughness));
  return frame.open() + frame.axes() + "<path class=\"line\" clip-path=\"url(#" + frame.clip() + ")\" d=\"" +
         line + "\"/>" + frame.circle(regularised.point.misfit, regularised.point.roughness, "chosen", 4.5) +
         "</svg>";
}

std::string field_plot(const SceneFitReport& report, const FittedField& field) {
  const Description& scene = report.scenes[field.scene];
  if (scene.dimension != 2 || field.values.size() > most_drawn_cells) return "";
  const BodyDescription& body = body_of(report, field);
  const CellBlock& cells = solid_cells(body, 2);
  PlotRange x, y;
  for (const Index node : cells.nodes) {
    x.include(body.mesh.vertices[static_cast<std::size_t>(node)].x());
    y.include(body.mesh.vertices[static_cast<std::size_t>(node)].y());
  }
  const double low = std::ranges::min(field.values), high = std::ranges::max(field.values);
  const auto scaled = [&](double value) {
    if (!(high > low)) return 0.5;
    return low > 0 ? std::log(value / low) / std::log(high / low) : (value - low) / (high - low);
  };
  make_alike(x, y);
  const std::string title = field.name == field.key ? field.body + ": " + field.constant : field.name;
  const std::string range = fmt::format("dark {:.3g} to light {:.3g} {};  x [m]", low, high, field.unit);
  const PlotFrame frame(title, "field-" + field_file_stem(field.body, field.constant), {range, x},
                        {"y [m]", y});
  std::string text = frame.open() + frame.axes();
  const auto corners = static_cast<std::size_t>(num_corners(cells.kind));
  for (Index c = 0; c < cells.num_cells(); ++c) {
    const Color color = map_color("viridis", scaled(field.values[static_cast<std::size_t>(c)]));
    const std::string name = fmt::format("#{:02x}{:02x}{:02x}", color.red, color.green, color.blue);
    text += "<polygon class=\"cell\" fill=\"" + name + "\" stroke=\"" + name + "\" points=\"";
    for (const Index node : cells.cell(c).first(corners)) {
      const Vector3& place = body.mesh.vertices[static_cast<std::size_t>(node)];
      text += fmt::format("{:.1f},{:.1f} ", frame.at_x(place.x()), frame.at_y(place.y()));
    }
    text += "\"/>";
  }
  return text + "</svg>";
}

std::string field_file_stem(const std::string& body, const std::string& constant) {
  std::string name = body + "_" + constant;
  std::ranges::replace_if(name, [](char c) { return c == '/' || c == '\\'; }, '_');
  return name;
}

void write_field(const SceneFitReport& report, const FittedField& field, const std::filesystem::path& path) {
  const BodyDescription& body = body_of(report, field);
  const std::vector<CellBlock> blocks = {solid_cells(body, report.scenes[field.scene].dimension)};
  write_vtu(path, {.points = body.mesh.vertices,
                   .blocks = blocks,
                   .point_data = {},
                   .cell_data = {{field.constant, 1, field.values},
                                 {field.constant + "_lower_95", 1, field.lower_95},
                                 {field.constant + "_upper_95", 1, field.upper_95},
                                 {"resolution", 1, field.resolution}}});
}

}  // namespace resilin
