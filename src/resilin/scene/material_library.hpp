#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "resilin/world/description.hpp"

namespace resilin {

/// A material with a name and a source. The data are lines of material_library.inc.
struct LibraryMaterial {
  std::string name, law;
  std::map<std::string, double> constants;  ///< constants of the law's formula
  double density = 0;                       ///< typical for it [kg/m^3]
  double youngs_modulus = 0;                ///< at small strain, of a sudden load [Pa]
  std::vector<double> g, tau;               ///< Prony series; empty: elastic [s]
  std::string range;                        ///< range of validity, in words
  std::string about;                        ///< the material, in words
  std::string source;
};

/// In the order of the data.
const std::vector<LibraryMaterial>& material_library();

/// One of them. Throws InputError at `place` with the nearest name.
const LibraryMaterial& find_library_material(const std::string& name, const std::string& place);

/// With law, constants, density and Prony series of one of them.
void take_from_library(const LibraryMaterial& from, MaterialDescription& material);

}  // namespace resilin
