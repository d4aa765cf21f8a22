#include "resilin/energy/time_function.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace resilin {

double time_slack(double time) { return 1e-9 * std::abs(time); }

namespace {

double angle(const TimeFunction::Sine& sine, double time) {
  return 2 * std::numbers::pi * sine.frequency * time + sine.phase * std::numbers::pi / 180;
}

/// Number of the segment that ends at or after `time`: from point i - 1 to point i; 0 or times.size()
/// outside.
std::size_t segment_before(const TimeFunction::Table& table, double time) {
  const auto point = std::lower_bound(table.times.begin(), table.times.end(), time - time_slack(time));
  return static_cast<std::size_t>(point - table.times.begin());
}

double slope(const TimeFunction::Table& table, std::size_t i) {
  return (table.values[i] - table.values[i - 1]) / (table.times[i] - table.times[i - 1]);
}

struct Value {
  double time;
  double operator()(const TimeFunction::Constant&) const { return 1; }
  double operator()(const TimeFunction::Table& table) const {
    const std::size_t i = segment_before(table, time);
    if (i == 0) return table.values.front();
    if (i == table.times.size()) return table.values.back();
    return table.values[i] + (time - table.times[i]) * slope(table, i);
  }
  double operator()(const TimeFunction::Sine& sine) const {
    return sine.offset + sine.amplitude * std::sin(angle(sine, time));
  }
  double operator()(const TimeFunction::Ramp& ramp) const {
    return std::clamp((time - ramp.from) / (ramp.until - ramp.from), 0.0, 1.0);
  }
};

struct Rate {
  double time;
  double operator()(const TimeFunction::Constant&) const { return 0; }
  double operator()(const TimeFunction::Table& table) const {
    const std::size_t i = segment_before(table, time);
    return i == 0 || i == table.times.size() ? 0 : slope(table, i);
  }
  double operator()(const TimeFunction::Sine& sine) const {
    return 2 * std::numbers::pi * sine.frequency * sine.amplitude * std::cos(angle(sine, time));
  }
  double operator()(const TimeFunction::Ramp& ramp) const {
    const bool rises = time > ramp.from + time_slack(time) && time <= ramp.until + time_slack(time);
    return rises ? 1 / (ramp.until - ramp.from) : 0;
  }
};

/// The integral up to a time, but for a constant.
struct Primitive {
  double time;
  double operator()(const TimeFunction::Constant&) const { return time; }
  double operator()(const TimeFunction::Table& table) const {
    const std::vector<double>&t = table.times, &f = table.values;
    if (time <= t.front()) return (time - t.front()) * f.front();
    double sum = 0;
    for (std::size_t i = 1; i < t.size() && t[i - 1] < time; ++i) {
      const double end = std::min(time, t[i]);
      sum += (end - t[i - 1]) * (f[i - 1] + 0.5 * (end - t[i - 1]) * slope(table, i));
    }
    return sum + std::max(time - t.back(), 0.0) * f.back();
  }
  double operator()(const TimeFunction::Sine& sine) const {
    const double rate = 2 * std::numbers::pi * sine.frequency;
    return sine.offset * time - sine.amplitude * std::cos(angle(sine, time)) / rate;
  }
  double operator()(const TimeFunction::Ramp& ramp) const {
    const double rise = std::clamp(time, ramp.from, ramp.until) - ramp.from;
    return 0.5 * rise * rise / (ramp.until - ramp.from) + std::max(time - ramp.until, 0.0);
  }
};

}  // namespace

double TimeFunction::integral(double time) const {
  return std::visit(Primitive{time}, form) - std::visit(Primitive{0}, form);
}

double TimeFunction::value(double time) const { return std::visit(Value{time}, form); }

double TimeFunction::rate(double time) const { return std::visit(Rate{time}, form); }

double TimeFunction::second_rate(double time) const {
  const Sine* sine = std::get_if<Sine>(&form);
  if (sine == nullptr) return 0;
  const double w = 2 * std::numbers::pi * sine->frequency;
  return -w * w * sine->amplitude * std::sin(angle(*sine, time));
}

std::vector<double> TimeFunction::kinks() const {
  if (const Table* table = std::get_if<Table>(&form)) return table->times;
  if (const Ramp* ramp = std::get_if<Ramp>(&form)) return {ramp->from, ramp->until};
  return {};
}

}  // namespace resilin
