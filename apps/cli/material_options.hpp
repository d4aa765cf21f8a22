#pragma once

#include <string>
#include <vector>

#include "resilin/material/derive.hpp"

namespace resilin::cli {

/// The material that a command line names.
struct MaterialOptions {
  double youngs_modulus = 1e6;  ///< [Pa]
  double poissons_ratio = 0.3;
  bool gives_hooke = false;            ///< one of the two stands on the command line
  std::vector<std::string> constants;  ///< "NAME=VALUE"
  std::vector<double> fibres;  ///< three numbers for each family; none: one along x where the law can have it
};

/// The law with the constants asked for, else with an example's. Throws InputError for what the law refuses.
Material chosen_material(const LawInfo& law, const MaterialOptions& options);

/// Where the constants come from: "E = 1e+06 Pa, nu = 0.3", or "shear_modulus = 2e+05, ...".
std::string constants_text(const LawInfo& law, const MaterialOptions& options);

}  // namespace resilin::cli
