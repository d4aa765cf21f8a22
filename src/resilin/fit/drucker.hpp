#pragma once

#include <optional>
#include <span>
#include <vector>

#include "resilin/fit/homogeneous_model.hpp"

namespace resilin {

/// Drucker's condition: more strain takes more stress, whatever its direction. With h_i = ln l_i the
/// Kirchhoff stresses are dPsi/dh_i, and the Hessian of Psi by h has to be positive definite: over the two
/// directions without change of volume in the incompressible limit, else over all three.
///
/// The Hessian is d2Psi/dh_i dh_j = l_i (dP_i/dl_j) l_j + [i = j] l_i P_i, divided here by l_1^2 + l_2^2 +
/// l_3^2, which leaves about twice the shear modulus.

/// At these states, in an orthonormal basis of the directions (2 x 2 or 3 x 3); not numbers where the law has
/// no state.
std::vector<DenseMatrix> stability_hessians(const LawInfo& law, bool is_compressible,
                                            std::span<const double> constants,
                                            const std::vector<LoadedState>& states);

/// Its smallest eigenvalue; minus infinity where there is no state.
double smallest_stiffness(const DenseMatrix& hessian);

/// Between which loads a law is stable along the path of a mode; nothing: to the end of the search, stretches
/// 1/12 and 12 (amount of shear 12), or the end of the data where these go further. In simple shear both
/// directions are the same and only `above` is told.
struct StabilityRange {
  TestMode mode;
  std::optional<double> below, above;
};

/// @param data_load  the load furthest from rest that has been measured in this mode; the search goes beyond
StabilityRange find_stability_range(const LawInfo& law, bool is_compressible,
                                    std::span<const double> constants, TestMode mode, double data_load = 1);

/// So many loads between these two, rest included, spaced evenly in ln l (in g for shear).
std::vector<LoadedState> states_between(TestMode mode, double from, double to, int count);

}  // namespace resilin
