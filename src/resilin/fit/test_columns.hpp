#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "resilin/fit/material_test.hpp"
#include "resilin/scene/csv.hpp"

namespace resilin {

/// Quantity of a column.
enum class ColumnRole {
  stretch,
  strain,        ///< engineering strain, stretch - 1
  shear,         ///< amount of shear
  volume_ratio,  ///< volume ratio of a volumetric test
  displacement,  ///< displacement of the end, over `length`
  nominal_stress,
  pressure,  ///< pressure of a volumetric test, positive where it compresses
  force,     ///< over `area`
  sigma,     ///< standard deviation of the stress
};
constexpr std::array<std::string_view, 9> spellings(ColumnRole) {
  return {"stretch",        "strain",   "shear", "volume_ratio", "displacement",
          "nominal_stress", "pressure", "force", "sigma"};
}

/// A [[test]] as it is written.
struct RawTest {
  std::string name;
  TestMode mode = TestMode::uniaxial;
  std::string file;                                 ///< as it is written, for messages
  NumberTable table;                                ///< table of the file
  std::map<ColumnRole, std::string> columns;        ///< names that the user gives
  std::map<ColumnRole, std::vector<double>> lists;  ///< columns written in place
  std::optional<std::string> unit;
  std::optional<double> sigma;
  double weight = 1;
  double length = 0, area = 0;  ///< length and area of the specimen at rest, in length_unit; 0: not given
  std::string length_unit = "m", force_unit = "N";
};

/// The test in SI units. Throws InputError at `place` for columns that are missing or of unequal length, and
/// for stretches that are none.
/// @param warnings  joined by what is odd and not wrong
MaterialTest test_of(const RawTest& raw, const std::string& place, std::vector<std::string>& warnings);

}  // namespace resilin
