#pragma once

#include <array>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "resilin/fit/description.hpp"
#include "resilin/fit/drucker.hpp"
#include "resilin/material/derive.hpp"

namespace resilin {

/// Origin of the value of a constant.
enum class ConstantOrigin {
  fitted,   ///< from the tests
  given,    ///< by the user
  assumed,  ///< from poissons_ratio, where the tests tell nothing about the volume
  absent,   ///< constant of a term that is not there
};
constexpr std::array<std::string_view, 4> spellings(ConstantOrigin) {
  return {"fitted", "given", "assumed", "absent"};
}

/// Estimate of one constant from the tests; SI.
struct ConstantEstimate {
  std::string name, unit;
  double value = 0;
  double standard_error = std::numeric_limits<double>::infinity();  ///< infinite: not determined
  double half_width_95 = std::numeric_limits<double>::infinity();
  ConstantOrigin origin = ConstantOrigin::fitted;
  bool is_determined = true;

  bool is_fitted() const { return origin == ConstantOrigin::fitted; }
};

/// Two constants that trade off against each other.
struct Correlation {
  std::string first, second;
  double value;
  std::string text;  ///< "only c10 + c01 is determined by these tests"
};

/// Fit of a model to one test.
struct TestQuality {
  std::string test;
  double r_squared;
  double root_mean_square;  ///< root mean square of P_model - P_measured [Pa]
  double largest;           ///< difference [Pa]
};

/// A curve to draw, beyond the data on both sides.
struct FittedCurve {
  TestMode mode;
  std::vector<double> load, stress;  ///< [Pa]; not a number where there is no state
  std::vector<bool> is_stable;
};

/// Statement of the data about several numbers.
struct Estimates {
  std::vector<ConstantEstimate> constants;
  double condition = 1;  ///< condition of the normal matrix with columns of length 1
  /// (fitted, fitted) between the estimates, row by row, in the order of the fitted constants.
  std::vector<double> correlation_matrix;
  std::vector<Correlation> correlations;  ///< above 0.95, the strongest first
  std::vector<std::string> warnings;      ///< one line each
};

/// One law, fitted.
struct LawFit : Estimates {
  std::string name;                ///< "ogden2"
  Material material;               ///< ready for a scene
  bool volume_is_assumed = false;  ///< the constant of the volume comes from poissons_ratio

  double sum_of_squares = 0;  ///< sum of squares of weighted residuals; [Pa^2] where they are absolute
  int num_points = 0, num_fitted = 0;
  double aicc = 0, akaike_weight = 0;
  std::vector<TestQuality> tests;  ///< one for each test
  std::vector<StabilityRange> stability;
  std::vector<FittedCurve> curves;  ///< one for each mode that is shown

  double shear_modulus = 0, bulk_modulus = 0;  ///< at small strain [Pa]; bulk: infinite in the limit
  double youngs_modulus = 0,
         poissons_ratio =
             0;  ///< Young's modulus and Poisson's ratio of the fit, in the incompressible limit 3 mu and 0.5
  bool is_usable = true;                      ///< a scene takes the material
  bool is_bounded = false;                    ///< stability or a range holds it
  std::optional<double> free_sum_of_squares;  ///< without that
  std::vector<std::string> remarks;           ///< one line each
};

/// A constitutive model that could not be fitted, and why.
struct LawNotFitted {
  std::string name, reason;
};

/// Result of `resilin fit`.
struct FitReport {
  FitDescription description;
  bool is_compressible = false;
  std::vector<LawFit> laws;  ///< the best first
  std::vector<LawNotFitted> not_fitted;
  std::vector<std::string> warnings;
};

/// Fits all laws of the description and ranks them by AICc. Throws InputError for what cannot be fitted:
/// fewer data than constants, residuals without what they need, tests that a law cannot follow.
FitReport fit_materials(FitDescription description);

}  // namespace resilin
