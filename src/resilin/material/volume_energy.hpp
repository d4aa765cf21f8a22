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

// For one block of lanes (core/simd.hpp), in the rows of a law's kernels (kernels/law_kernels.hpp):

/// J - 1 of shifted stretches.
void volume_of_stretches(const double* stretches, double* j);

/// Adds a volumetric energy, of which dU/dJ and d2U/dJ2 are given, to the rows of a law's gradient; to those
/// of its curvature where `stiffness` is not null.
void add_volume_energy(LawKind kind, const double* variables, const double* pressure, const double* stiffness,
                       double* rows);

}  // namespace resilin
