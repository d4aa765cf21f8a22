#include "resilin/picture/color_scale.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "resilin/core/text.hpp"

namespace resilin {
namespace {

constexpr std::array<const char*, 10> superscripts = {
    "\xE2\x81\xB0", "\xC2\xB9",     "\xC2\xB2",     "\xC2\xB3",     "\xE2\x81\xB4",
    "\xE2\x81\xB5", "\xE2\x81\xB6", "\xE2\x81\xB7", "\xE2\x81\xB8", "\xE2\x81\xB9"};

/// The power of ten below `value` that is a multiple of three, for numbers from 1 to 999.
int thousands_exponent(double value) {
  if (!(value > 0)) return 0;
  return 3 * static_cast<int>(std::floor(std::log10(value) / 3 + 1e-12));
}

std::string power_of_ten(int exponent) {
  std::string text = "10";
  if (exponent < 0) text += "\xE2\x81\xBB";
  for (const char digit : std::to_string(std::abs(exponent)))
    text += superscripts[static_cast<std::size_t>(digit - '0')];
  return text;
}

/// "J/m^3" with a raised 3.
std::string raised(std::string unit) {
  for (std::size_t i = unit.find('^'); i != unit.npos && i + 1 < unit.size(); i = unit.find('^'))
    unit.replace(i, 2, superscripts[static_cast<std::size_t>(unit[i + 1] - '0')]);
  return unit;
}

/// "kPa" for 3 and "Pa"; empty when there is no such prefix.
std::string with_prefix(int exponent, const std::string& unit) {
  constexpr std::array<const char*, 9> prefixes = {"p", "n", "\xC2\xB5", "m", "", "k", "M", "G", "T"};
  const int place = exponent / 3 + 4;
  if (place < 0 || place >= static_cast<int>(prefixes.size())) return {};
  return prefixes[static_cast<std::size_t>(place)] + raised(unit);
}

/// 1, 2, 2.5 or 5 times a power of ten, so that about six fit into `span`.
double round_step(double span) {
  const double power = std::pow(10, std::floor(std::log10(span / 6)));
  for (const double factor : {1.0, 2.0, 2.5, 5.0})
    if (span / (factor * power) <= 6 + 1e-9) return factor * power;
  return 10 * power;
}

int decimals_of(double step) {
  int decimals = 0;
  for (double rest = step; decimals < 12 && std::abs(rest - std::round(rest)) > 1e-6 * rest; rest *= 10)
    ++decimals;
  return decimals;
}

}  // namespace

ColorScale choose_scale(std::span<const double> values, const std::optional<std::array<double, 2>>& range,
                        const std::string& map, double smallest) {
  ColorScale scale;
  double least = std::numeric_limits<double>::infinity(), greatest = -least;
  for (const double value : values) {
    if (!std::isfinite(value)) continue;
    least = std::min(least, value);
    greatest = std::max(greatest, value);
  }
  if (least > greatest) least = greatest = 0;
  scale.least = least;
  scale.greatest = greatest;
  const double size = std::max(std::abs(least), std::abs(greatest));
  if (range) {
    least = (*range)[0];
    greatest = (*range)[1];
  }
  // Small values of the other sign are overshoots of smoothing rather than a second side.
  const bool has_two_sides = least < -0.02 * size && greatest > 0.02 * size;
  scale.map = map == "auto" ? (has_two_sides ? "diverging" : "viridis") : map;
  if (!range && scale.map == "diverging") {
    greatest = size;
    least = -size;
  }
  // A field that is the same everywhere up to round-off has its value in the middle of the bar.
  if (greatest - least <= std::max(1e-9 * size, range ? 0 : smallest) || greatest <= least) {
    const double half = std::max(size > 0 ? 0.5 * size : 1, smallest);
    const double middle = 0.5 * (least + greatest);
    least = middle - half;
    greatest = middle + half;
  }
  scale.low = least;
  scale.high = greatest;
  return scale;
}

ScaleText scale_text(const ColorScale& scale, const std::string& label, const std::string& unit) {
  const double size = std::max(std::abs(scale.low), std::abs(scale.high));
  int exponent = thousands_exponent(size);
  if (unit.empty() && size >= 0.01 && size < 1e4) exponent = 0;
  std::string shown_unit = unit.empty() ? "" : with_prefix(exponent, unit);
  if (!unit.empty() && shown_unit.empty()) {
    exponent = 0;
    shown_unit = raised(unit);
  }
  if (unit.empty() && exponent != 0) shown_unit = power_of_ten(exponent);
  ScaleText text{
      .title = shown_unit.empty() ? label : label + " [" + shown_unit + "]", .ticks = {}, .extremes = {}};
  const double factor = std::pow(10, -exponent), low = factor * scale.low, high = factor * scale.high;
  const double step = round_step(high - low);
  const int decimals = decimals_of(step);
  for (double k = std::ceil(low / step - 1e-6); k * step <= high + 1e-6 * step; ++k)
    text.ticks.push_back(
        {std::clamp((k * step - low) / (high - low), 0.0, 1.0), format_fixed(k * step, decimals)});
  const int more = decimals + 1;
  text.extremes = "min " + format_fixed(factor * scale.least, more) + "   max " +
                  format_fixed(factor * scale.greatest, more);
  return text;
}

}  // namespace resilin
