#pragma once

#include <span>
#include <vector>

#include "resilin/core/instruction_set.hpp"
#include "resilin/material/law.hpp"

namespace resilin {

/// Derivatives of the volumetric energy U(J) of a constitutive model [Pa].
struct VolumeSlopes {
  double pressure;   ///< dU/dJ
  double stiffness;  ///< d2U/dJ2
};

/// For a model with a separate volumetric energy (`has_volume_energy`), at one state after another. Outside
/// the model's domain the derivatives are not numbers.
/// @param j          J - 1
/// @param constants  of the model's formula, in its order
std::vector<VolumeSlopes> volume_slopes(const LawInfo& law, std::span<const double> j,
                                        std::span<const Column> constants, InstructionSet set);

}  // namespace resilin
