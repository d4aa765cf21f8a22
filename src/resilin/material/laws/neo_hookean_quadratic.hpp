#pragma once

#include <array>

#include "resilin/material/hooke.hpp"
#include "resilin/material/invariants.hpp"
#include "resilin/material/law_text.hpp"

namespace resilin {

/// Neo-Hookean solid with a quadratic volume term.
///
///   Psi = mu/2 (I_C - 3) - mu ln J + lambda/2 (J - 1)^2
template <class Real = double>
struct NeoHookeanQuadratic {
  static constexpr LawKind kind = LawKind::invariants;
  static constexpr std::string_view name = "neo_hookean_quadratic";
  static constexpr std::string_view title = "Neo-Hookean quadratic";
  static constexpr std::string_view formula = "mu/2 (I_C - 3) - mu ln J + lambda/2 (J - 1)^2";
  static constexpr std::string_view source = "Ogden 1997, ch. 7; Wang & Yang 2016";
  static constexpr std::string_view inversion = "energy is infinite at J <= 0";
  static constexpr bool needs_positive_J = true;
  static constexpr bool uses_second_invariant = false;
  static constexpr std::array constants = {shear_modulus_text, lame_lambda_text};

  Real mu;      // shear modulus [Pa]
  Real lambda;  // Lame's lambda [Pa]

  static NeoHookeanQuadratic from(const Hooke& hooke) { return {hooke.mu, hooke.lambda}; }

  /// The part that depends on J alone and resists changes of volume [J/m^3]; j = J - 1.
  template <class T>
  T volume_energy(const T& j) const {
    return 0.5 * lambda * square(j);
  }

  template <class T>
  T energy_density(const Invariants<T>& c) const {
    return 0.5 * mu * c.d1 - mu * log1p_minus(c.j) + volume_energy(c.j);
  }
};

}  // namespace resilin
