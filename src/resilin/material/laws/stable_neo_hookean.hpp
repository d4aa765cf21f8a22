#pragma once

#include <array>

#include "resilin/material/hooke.hpp"
#include "resilin/material/invariants.hpp"
#include "resilin/material/law_text.hpp"

namespace resilin {

/// Stable Neo-Hookean flesh: finite for every F, so an inverted element is pushed back.
///
///   Psi = mu/2 (I_C - 3) - mu (J - 1) + lambda/2 (J - 1)^2
///
/// It is mu/2 (I_C - 3) + lambda/2 (J - 1 - mu/lambda)^2 less its value at rest. Hooke's stiffness needs
/// lambda = Hooke's lambda + mu, which `from` does.
template <class Real = double>
struct StableNeoHookean {
  static constexpr LawKind kind = LawKind::invariants;
  static constexpr std::string_view name = "stable_neo_hookean";
  static constexpr std::string_view title = "Stable Neo-Hookean";
  static constexpr std::string_view formula = "mu/2 (I_C - 3) - mu (J - 1) + lambda/2 (J - 1)^2";
  static constexpr std::string_view source = "Smith, de Goes & Kim 2018, eq. 13";
  static constexpr std::string_view inversion = "finite for every F; an inverted cell is pushed back";
  static constexpr bool needs_positive_J = false;
  static constexpr bool uses_second_invariant = false;
  static constexpr std::array constants = {shear_modulus_text, lame_lambda_text};

  Real mu;      // shear modulus [Pa]
  Real lambda;  // the paper's lambda [Pa]

  static StableNeoHookean from(const Hooke& hooke) { return {hooke.mu, hooke.lambda + hooke.mu}; }

  /// The part of Hooke's lambda [J/m^3]; j = J - 1. With all of the paper's lambda in it, what is left would
  /// soften with changes of volume, and cells that see this part in the mean alone would not be stable at
  /// rest.
  template <class T>
  T volume_energy(const T& j) const {
    return 0.5 * (lambda - mu) * square(j);
  }

  template <class T>
  T energy_density(const Invariants<T>& c) const {
    return 0.5 * mu * c.d1 + 0.5 * lambda * square(c.j);
  }
};

}  // namespace resilin
