#pragma once

#include <array>

#include "resilin/material/hooke.hpp"
#include "resilin/material/law_text.hpp"
#include "resilin/material/stretches.hpp"

namespace resilin {

/// Hooke's law in the frame that turns with the material: F = R S, S - I in place of the small strain.
///
///   Psi = mu |F - R|^2 + lambda/2 (tr(R^T F) - 3)^2
template <class Real = double>
struct CorotatedLinear {
  static constexpr LawKind kind = LawKind::stretches;
  static constexpr std::string_view name = "corotated_linear";
  static constexpr std::string_view title = "Corotated linear";
  static constexpr std::string_view formula = "mu |F - R|^2 + lambda/2 (tr(R^T F) - 3)^2, F = R S";
  static constexpr std::string_view source = "Mueller & Gross 2004; Sifakis & Barbic 2012, sec. 3.4";
  static constexpr std::string_view inversion =
      "finite; R is not unique, and nothing is returned, where the two smallest signed stretches cancel";
  static constexpr bool needs_positive_J = false;
  static constexpr bool uses_second_invariant = false;
  static constexpr std::array constants = {shear_modulus_text, lame_lambda_text};

  Real mu;      // shear modulus [Pa]
  Real lambda;  // Lame's lambda [Pa]

  static CorotatedLinear from(const Hooke& hooke) { return {hooke.mu, hooke.lambda}; }

  template <class T>
  T energy_density(const Stretches<T>& c) const {
    return mu * c.square + 0.5 * lambda * square(c.trace);
  }
};

}  // namespace resilin
