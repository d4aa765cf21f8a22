#pragma once

#include <array>

#include "resilin/material/hooke.hpp"
#include "resilin/material/invariants.hpp"
#include "resilin/material/law_text.hpp"

namespace resilin {

/// Neo-Hookean solid with the squared logarithm.
///
///   Psi = mu/2 (I_C - 3) - mu ln J + lambda/2 (ln J)^2
template <class Real = double>
struct NeoHookean {
  static constexpr LawKind kind = LawKind::invariants;
  static constexpr std::string_view name = "neo_hookean";
  static constexpr std::string_view title = "Neo-Hookean";
  static constexpr std::string_view formula = "mu/2 (I_C - 3) - mu ln J + lambda/2 (ln J)^2";
  static constexpr std::string_view source = "Bonet & Wood 2008, eq. 6.28";
  static constexpr std::string_view inversion = "energy is infinite at J <= 0; softens beyond J = e";
  static constexpr bool needs_positive_J = true;
  static constexpr bool uses_second_invariant = false;
  static constexpr std::array constants = {shear_modulus_text, lame_lambda_text};

  Real mu;      // shear modulus [Pa]
  Real lambda;  // Lame's lambda [Pa]

  static NeoHookean from(const Hooke& hooke) { return {hooke.mu, hooke.lambda}; }

  /// The part that depends on J alone and resists changes of volume [J/m^3]; j = J - 1.
  template <class T>
  T volume_energy(const T& j) const {
    return 0.5 * lambda * square(log1p(j));
  }

  template <class T>
  T energy_density(const Invariants<T>& c) const {
    return 0.5 * mu * c.d1 - mu * log1p_minus(c.j) + volume_energy(c.j);
  }
};

}  // namespace resilin
