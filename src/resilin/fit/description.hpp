#pragma once

#include <array>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "resilin/fit/material_test.hpp"

namespace resilin {

/// Residual of the objective, the sum of weight * residual^2 over all points.
enum class ResidualKind {
  absolute,  ///< P_model - P_measured
  relative,  ///< (P_model - P_measured) / P_measured
  sigma,     ///< (P_model - P_measured) / sigma
};
constexpr std::array<std::string_view, 3> spellings(ResidualKind) {
  return {"absolute", "relative", "sigma"};
}

/// Treatment of constants that are unstable within the data (Drucker's condition).
enum class StabilityRule {
  required,  ///< the best constants that are stable there
  report,    ///< said, not prevented
  off,       ///< not looked at
};
constexpr std::array<std::string_view, 3> spellings(StabilityRule) { return {"required", "report", "off"}; }

/// How a fit treats the volume of specimens.
enum class VolumeRule {
  automatic,       ///< compressible when a test changes the volume
  incompressible,  ///< the limit in which the volume stays
  compressible,    ///< lateral stretches follow from stress-free faces
};
constexpr std::array<std::string_view, 3> spellings(VolumeRule) {
  return {"auto", "incompressible", "compressible"};
}

/// Settings of a constant: "limit", or "gent.limit" of one law alone. Stresses in Pa.
struct ConstantSetting {
  std::string name;
  std::string place;
  std::optional<double> start = {}, value = {};  ///< value: it is not fitted
  double lower = -std::numeric_limits<double>::infinity();
  double upper = std::numeric_limits<double>::infinity();
};

/// Input of `resilin fit`.
struct FitDescription {
  std::string place = "fit";
  std::string title;
  std::vector<MaterialTest> tests;
  std::vector<std::string> laws;  ///< empty: usual_fit_laws()
  ResidualKind residual = ResidualKind::absolute;
  StabilityRule stability = StabilityRule::required;
  VolumeRule volume = VolumeRule::automatic;
  /// Poisson's ratio that is written where the tests tell nothing about the volume.
  double poissons_ratio = 0.495;
  std::vector<ConstantSetting> constants;
  std::vector<std::string> warnings;  ///< warnings of the reader
};

}  // namespace resilin
