#pragma once

#include <vector>

#include "resilin/fit/description.hpp"
#include "resilin/fit/homogeneous_model.hpp"

namespace resilin {

/// All points of all tests, one after another, and how they are weighed.
struct FitData {
  std::vector<LoadedState> states;
  VectorX measured;          ///< [Pa]
  VectorX weights;           ///< weights of residuals in units of stress_scale
  double stress_scale = 1;   ///< the largest stress [Pa]
  double shear_modulus = 0;  ///< rough shear modulus of the tests [Pa]
};

/// Whether laws may change their volume in this fit.
bool is_compressible_fit(const FitDescription& description);

/// Throws InputError for residuals that lack what they need and tests that cannot be.
FitData collect_data(const FitDescription& description, bool is_compressible);

/// Troubles with units, which throw where no unit was given, and other oddities.
std::vector<std::string> data_warnings(const FitDescription& description);

/// I_C - 3 at J = 1 of a state that keeps its volume: how far it is strained.
double isochoric_strain(const LoadedState& state);

}  // namespace resilin
