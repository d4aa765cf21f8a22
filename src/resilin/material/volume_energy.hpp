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

/// Adds a volumetric energy to the rows of a law's gradient or curvature.
/// @param variables  of the law
/// @param pressure   dU/dJ; null where that is not to be added
/// @param stiffness  d2U/dJ2, for curvatures; null likewise
/// @param has_curvature  whether the rows are those of the curvature
void add_volume_energy(LawKind kind, const double* variables, const double* pressure, const double* stiffness,
                       bool has_curvature, double* rows);

}  // namespace resilin
