#include "resilin/fit/scene_plot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "resilin/fit/plot_frame.hpp"

namespace resilin {
namespace {

std::string in_unit(const std::string& what, const TableQuality& table) {
  return what + " [" + unit_of(table.kind) + "]";
}

/// One row of a table with what was measured of it.
struct PlottedRow {
  Vector3 at;
  std::optional<double> moment;
  std::array<std::optional<double>, 3> measured, model;
};

std::vector<PlottedRow> rows_of(const TableQuality& table) {
  std::vector<PlottedRow> rows;
  const std::string* last = nullptr;
  for (const FittedValue& value : table.values) {
    if (last == nullptr || *last != value.of.row) rows.push_back({value.of.at, value.of.moment, {}, {}});
    last = &value.of.row;
    rows.back().measured[static_cast<std::size_t>(value.of.component)] = value.measured;
    rows.back().model[static_cast<std::size_t>(value.of.component)] = value.model;
  }
  return rows;
}

/// Rows of the last moment that is measured.
std::vector<PlottedRow> last_rows(const TableQuality& table) {
  std::vector<PlottedRow> rows = rows_of(table);
  const auto later = [](const PlottedRow& a, const PlottedRow& b) {
    return b.moment.has_value() && (!a.moment || *a.moment > *b.moment);
  };
  const std::optional<double> last = std::ranges::min_element(rows, later)->moment;
  std::erase_if(rows, [&](const PlottedRow& row) { return row.moment != last; });
  return rows;
}

}  // namespace

std::string agreement_plot(const TableQuality& table, const std::string& name) {
  PlotRange range;
  for (const FittedValue& value : table.values) {
    range.include(value.measured);
    range.include(value.model);
  }
  range = range.widened(0.06);
  const PlotFrame frame(table.name, name, {in_unit("measured", table), range},
                        {in_unit("model", table), range});
  std::string text = frame.open() + frame.axes();
  text += fmt::format("<path class=\"same\" clip-path=\"url(#{})\" d=\"M{:.2f} {:.2f}L{:.2f} {:.2f}\"/>",
                      frame.clip(), frame.at_x(range.low), frame.at_y(range.low), frame.at_x(range.high),
                      frame.at_y(range.high));
  for (const FittedValue& value : table.values)
    text += frame.circle(value.measured, value.model, "model component-" + std::to_string(value.of.component),
                         2.4);
  return text + "</svg>";
}

std::string marker_plot(const TableQuality& table, const std::string& name) {
  if (table.kind != MeasuredKind::markers) return "";
  const std::vector<PlottedRow> rows = last_rows(table);
  std::array<PlotRange, 3> extents;
  for (const PlottedRow& row : rows)
    for (std::size_t i = 0; i < 3; ++i) {
      extents[i].include(row.at[static_cast<int>(i)]);
      extents[i].include(row.at[static_cast<int>(i)] + row.measured[i].value_or(0));
    }
  const auto length = [&](std::size_t i) { return extents[i].high - extents[i].low; };
  const std::size_t out = length(2) <= std::min(length(0), length(1)) ? 2 : length(1) < length(0) ? 1 : 0;
  const std::size_t i = out == 0 ? 1 : 0, k = out == 2 ? 1 : 2;
  PlotRange x, y;
  std::string text;
  const auto place = [](const PlottedRow& row, const auto& moved, std::size_t axis) {
    return row.at[static_cast<int>(axis)] + *moved[axis];
  };
  for (const PlottedRow& row : rows) {
    if (!row.measured[i] || !row.measured[k]) continue;
    for (const auto* moved : {&row.measured, &row.model}) {
      x.include(place(row, *moved, i));
      y.include(place(row, *moved, k));
    }
  }
  if (x.is_empty() && y.is_empty()) return "";
  x = x.widened(0.06);
  y = y.widened(0.06);
  make_alike(x, y);
  const std::string letters = "xyz";
  const PlotFrame frame(table.name + ", where they went", name, {letters.substr(i, 1) + " [m]", x},
                        {letters.substr(k, 1) + " [m]", y});
  text = frame.open() + frame.axes();
  for (const PlottedRow& row : rows) {
    if (!row.measured[i] || !row.measured[k]) continue;
    text += frame.circle(place(row, row.measured, i), place(row, row.measured, k), "point", 3.2) +
            frame.circle(place(row, row.model, i), place(row, row.model, k), "model", 1.6);
  }
  return text + "</svg>";
}

std::string course_plot(const TableQuality& table, const std::string& name) {
  if (table.kind == MeasuredKind::markers) return "";
  std::set<double> moments;
  PlotRange x, y;
  for (const FittedValue& value : table.values) {
    if (!value.of.moment) return "";
    moments.insert(*value.of.moment);
    x.include(*value.of.moment);
    y.include(value.measured);
    y.include(value.model);
  }
  if (moments.size() < 3) return "";
  const PlotFrame frame(table.name, name, {table.is_dynamic ? "time [s]" : "load factor", x.widened(0.03)},
                        {in_unit("", table), y.widened(0.06)});
  std::string text = frame.open() + frame.axes();
  for (int component = 0; component < 3; ++component) {
    std::string line, circles;
    for (const FittedValue& value : table.values) {
      if (value.of.component != component) continue;
      line += fmt::format("{}{:.2f} {:.2f}", line.empty() ? "M" : "L", frame.at_x(*value.of.moment),
                          frame.at_y(value.model));
      circles += frame.circle(*value.of.moment, value.measured, "point", 2.7);
    }
    if (line.empty()) continue;
    text += fmt::format("<path stroke=\"var(--s{})\" d=\"{}\"/>", component, line) + circles;
  }
  return text + "</svg>";
}

std::string search_plot(const std::vector<SceneFitStep>& steps) {
  PlotRange x{0.5, static_cast<double>(steps.size()) + 0.5}, y;
  for (const SceneFitStep& step : steps)
    if (step.sum_of_squares > 0) y.include(step.sum_of_squares);
  y = {y.low / 1.5, y.high * 1.5};
  const PlotFrame frame("the search", "search", {"solve", x}, {"sum of squares", y, true});
  std::string text = frame.open() + frame.axes(), line, circles;
  double number = 0;
  for (const SceneFitStep& step : steps) {
    ++number;
    const bool is_shown = step.sum_of_squares > 0 && std::isfinite(step.sum_of_squares);
    const double sum = is_shown ? step.sum_of_squares : step.sum_of_squares > 0 ? y.high : y.low;
    if (step.is_better)
      line += fmt::format("{}{:.2f} {:.2f}", line.empty() ? "M" : "L", frame.at_x(number), frame.at_y(sum));
    circles += frame.circle(number, sum, step.is_better ? "model" : "failed", 3);
  }
  return text + "<path class=\"line\" d=\"" + line + "\"/>" + circles + "</svg>";
}

}  // namespace resilin
