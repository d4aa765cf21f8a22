#pragma once

#include <span>
#include <string>
#include <string_view>

namespace resilin {

/// A unit and what it is in SI units.
struct Unit {
  std::string_view name;
  double in_si;
};

/// The units that tables of tests may have, with their factors to SI units.
std::span<const Unit> stress_units();  ///< in Pa
std::span<const Unit> length_units();  ///< in m
std::span<const Unit> force_units();   ///< in N

/// The unit of this name; throws InputError(place, ...) that names the nearest when there is none.
const Unit& require_unit(std::span<const Unit> units, std::string_view name, const std::string& place);

/// The unit that a stress read as `read_as` may have had, when it is too small by `ratio`: "kgf/cm2 read as
/// Pa, a factor of 98066.5"; empty when no usual confusion comes within a factor of four.
std::string mistaken_unit(double ratio, std::string_view read_as);

}  // namespace resilin
