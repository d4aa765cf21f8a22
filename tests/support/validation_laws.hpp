#pragma once

#include <map>
#include <string>

namespace resilin::testing {

/// Names of our laws in the reference files, and of the constants of a formula.
struct ReferenceLaw {
  std::string law;
  std::map<std::string, double> constants;  ///< literal, not converted
  double rest_energy_density = 0;           ///< the files keep the constant of "snh" and "snh_log" [J/m^3]
};

/// From shear modulus and Lame's lambda put into the formula as they stand; kappa = lambda + 2 mu / 3.
ReferenceLaw reference_law(const std::string& key, double mu, double lambda);

/// The same from E and nu.
ReferenceLaw reference_law_from_young(const std::string& key, double youngs_modulus, double poissons_ratio);

}  // namespace resilin::testing
