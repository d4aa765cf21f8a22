#include "resilin/fit/units.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "resilin/core/error.hpp"
#include "resilin/core/text.hpp"

namespace resilin {
namespace {

// Standard gravity 9.80665 m/s^2, pound 0.45359237 kg, inch 0.0254 m: exact by definition.
constexpr double kilogram_force = 9.80665, pound_force = 0.45359237 * kilogram_force, inch = 0.0254;
constexpr double psi = pound_force / (inch * inch);

constexpr std::array all_stress_units = {
    Unit{"Pa", 1},
    Unit{"kPa", 1e3},
    Unit{"MPa", 1e6},
    Unit{"GPa", 1e9},
    Unit{"N/m2", 1},
    Unit{"N/mm2", 1e6},
    Unit{"N/cm2", 1e4},
    Unit{"kgf/cm2", 1e4 * kilogram_force},
    Unit{"bar", 1e5},
    Unit{"kgf/mm2", 1e6 * kilogram_force},
    Unit{"psi", psi},
    Unit{"ksi", 1e3 * psi},
    Unit{"dyn/cm2", 0.1},
    Unit{"gf/mm2", 1e3 * kilogram_force},
    Unit{"mmHg", 133.322387415},
};
constexpr std::array all_length_units = {Unit{"m", 1}, Unit{"cm", 1e-2}, Unit{"mm", 1e-3}, Unit{"um", 1e-6},
                                         Unit{"in", inch}};
constexpr std::array all_force_units = {Unit{"N", 1},
                                        Unit{"mN", 1e-3},
                                        Unit{"kN", 1e3},
                                        Unit{"gf", 1e-3 * kilogram_force},
                                        Unit{"kgf", kilogram_force},
                                        Unit{"lbf", pound_force}};

}  // namespace

std::span<const Unit> stress_units() { return all_stress_units; }
std::span<const Unit> length_units() { return all_length_units; }
std::span<const Unit> force_units() { return all_force_units; }

const Unit& require_unit(std::span<const Unit> units, std::string_view name, const std::string& place) {
  const auto found = std::ranges::find(units, name, &Unit::name);
  if (found != units.end()) return *found;
  std::vector<std::string> names;
  for (const Unit& unit : units) names.emplace_back(unit.name);
  refuse_word(place, name, names);
}

std::string mistaken_unit(double ratio, std::string_view read_as) {
  constexpr std::array<std::string_view, 5> usual = {"kPa", "psi", "kgf/cm2", "MPa", "Pa"};
  const double read = require_unit(stress_units(), read_as, "unit").in_si;
  double best = std::log(4.0);
  std::string text;
  for (const std::string_view unit : usual) {
    const double factor = require_unit(stress_units(), unit, "unit").in_si / read;
    const double distance = std::abs(std::log(ratio / factor));
    if (unit == read_as || !(distance < best)) continue;
    best = distance;
    text = std::string(unit) + " read as " + std::string(read_as) + ", a factor of " + format_number(factor);
  }
  return text;
}

}  // namespace resilin
