#pragma once

#include <array>

#include "resilin/material/hooke.hpp"
#include "resilin/material/invariants.hpp"
#include "resilin/material/law_text.hpp"

namespace resilin {

/// Stable Neo-Hookean flesh with a regularising logarithm; finite for every F.
///
///   Psi = mu/2 (I_C - 3) - mu/2 ln(I_C + 1) + lambda/2 (J - alpha)^2 - const, alpha = 1 + 3 mu/(4 lambda)
///
/// With i1 = d1 + 2 j the terms in j alone cancel and what is left is of second order; lambda divides
/// nothing. Hooke's stiffness needs mu = 4/3 Hooke's mu, lambda = Hooke's lambda + 5/6 Hooke's mu.
template <class Real = double>
struct StableNeoHookeanLog {
  static constexpr LawKind kind = LawKind::invariants;
  static constexpr std::string_view name = "stable_neo_hookean_log";
  static constexpr std::string_view title = "Stable Neo-Hookean log";
  static constexpr std::string_view formula =
      "mu/2 (I_C - 3) - mu/2 ln((I_C + 1)/4) - 3/4 mu (J - 1) + lambda/2 (J - 1)^2";
  static constexpr std::string_view source = "Smith, de Goes & Kim 2018, eq. 14";
  static constexpr std::string_view inversion = "finite for every F; an inverted cell is pushed back";
  static constexpr bool needs_positive_J = false;
  static constexpr bool uses_second_invariant = false;
  static constexpr std::array constants = {shear_modulus_text, lame_lambda_text};

  Real mu;      // the paper's mu [Pa]
  Real lambda;  // the paper's lambda [Pa]

  static StableNeoHookeanLog from(const Hooke& hooke) {
    return {4.0 / 3.0 * hooke.mu, hooke.lambda + 5.0 / 6.0 * hooke.mu};
  }

  /// The part of Hooke's lambda [J/m^3]; j = J - 1. With all of the paper's lambda in it, what is left would
  /// soften with changes of volume, and cells that see this part in the mean alone would not be stable at
  /// rest.
  template <class T>
  T volume_energy(const T& j) const {
    return 0.5 * (lambda - 0.625 * mu) * square(j);
  }

  template <class T>
  T energy_density(const Invariants<T>& c) const {
    return 0.375 * mu * c.d1 - 0.5 * mu * log1p_minus(0.25 * c.i1) + 0.5 * lambda * square(c.j);
  }
};

}  // namespace resilin
