#pragma once

#include <array>

#include "resilin/material/hooke.hpp"
#include "resilin/material/invariants.hpp"
#include "resilin/material/law_text.hpp"

namespace resilin {

/// Hooke's law in the Green strain E = (C - I)/2. Weak in compression: it lets a cell be flattened.
///
///   Psi = mu E:E + lambda/2 (tr E)^2
///
/// |C|^2 = I_C^2 - 2 II_C gives E:E = (i1^2 + 4 i1 - 2 i2)/4 = (i1^2 + 4 d1 - 2 d2)/4, and tr E = i1/2.
template <class Real = double>
struct SaintVenantKirchhoff {
  static constexpr LawKind kind = LawKind::invariants;
  static constexpr std::string_view name = "saint_venant_kirchhoff";
  static constexpr std::string_view title = "Saint Venant-Kirchhoff";
  static constexpr std::string_view formula = "mu E:E + lambda/2 (tr E)^2, E = (F^T F - I)/2";
  static constexpr std::string_view source = "Bonet & Wood 2008, eq. 6.13";
  static constexpr std::string_view inversion = "finite for every F; an inverted cell can stay inverted";
  static constexpr bool needs_positive_J = false;
  static constexpr bool uses_second_invariant = true;
  static constexpr std::array constants = {shear_modulus_text, lame_lambda_text};

  Real mu;      // shear modulus [Pa]
  Real lambda;  // Lame's lambda [Pa]

  static SaintVenantKirchhoff from(const Hooke& hooke) { return {hooke.mu, hooke.lambda}; }

  template <class T>
  T energy_density(const Invariants<T>& c) const {
    return mu * (c.d1 - 0.5 * c.d2) + (0.25 * mu + 0.125 * lambda) * square(c.i1);
  }
};

}  // namespace resilin
