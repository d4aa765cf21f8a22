#pragma once

#include <string>
#include <vector>

#include "resilin/fit/description.hpp"
#include "resilin/material/law.hpp"

namespace resilin {

/// A law with the constants that are fitted.
struct LawChoice {
  std::string name;  ///< "ogden2"
  const LawInfo* law;
  bool is_compressible;
  std::vector<double>
      constants;               ///< constants of all places: those that are not fitted have their value [SI]
  std::vector<int> linear;     ///< fitted, and the energy is linear in them together
  std::vector<int> nonlinear;  ///< fitted besides
  /// The constant that resists changes of volume alone; -1 when there is none. In the incompressible limit it
  /// is not fitted.
  int volume_constant = -1;
  std::vector<int> absent = {};  ///< constants of terms that are not there

  std::vector<int> fitted() const;  ///< in the order of the formula
};

/// Every name that `laws` may hold: those of the catalogue, ogden1, ogden2 and ogden3. "ogden" means ogden3.
std::vector<std::string> fit_law_names();
/// Laws that are fitted by default.
std::vector<std::string> usual_fit_laws();

/// The choice of this name; throws InputError(place, ...) that says why for a law that cannot be fitted to
/// homogeneous tests, or not in the incompressible limit.
LawChoice choose_law(const std::string& name, bool is_compressible, const std::string& place);

/// Fixes the constants that settings give a value. Throws InputError for a setting of no constant of
/// `choices`, and for bounds or values out of a law's range.
void apply_settings(std::vector<LawChoice>& choices, const std::vector<ConstantSetting>& settings);

/// Whether a setting is about the constant of this place.
bool is_about(const ConstantSetting& setting, const LawChoice& choice, int place);

/// Exchangeable terms in order: the one with the largest part of the small-strain modulus first.
void sort_terms(const LawChoice& choice, std::vector<double>& constants);

}  // namespace resilin
