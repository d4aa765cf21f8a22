#pragma once

#include <array>

#include "resilin/material/hooke.hpp"
#include "resilin/material/invariants.hpp"
#include "resilin/material/law_text.hpp"

namespace resilin {

/// Hooke's law in the small strain eps = sym(F) - I: for small displacements; a rotation strains it.
///
///   Psi = mu eps:eps + lambda/2 (tr eps)^2
template <class Real = double>
struct LinearElastic {
  static constexpr LawKind kind = LawKind::small_strain;
  static constexpr std::string_view name = "linear_elastic";
  static constexpr std::string_view title = "Linear elastic";
  static constexpr std::string_view formula = "mu eps:eps + lambda/2 (tr eps)^2, eps = (F + F^T)/2 - I";
  static constexpr std::string_view source = "Hooke 1678; Bower 2009, sec. 3.2";
  static constexpr std::string_view inversion = "finite for every F; blind to inversion";
  static constexpr bool needs_positive_J = false;
  static constexpr bool uses_second_invariant = false;
  static constexpr std::array constants = {shear_modulus_text, lame_lambda_text};

  Real mu;      // shear modulus [Pa]
  Real lambda;  // Lame's lambda [Pa]

  static LinearElastic from(const Hooke& hooke) { return {hooke.mu, hooke.lambda}; }

  template <class T>
  T energy_density(const SmallStrain<T>& e) const {
    return mu * e.square + 0.5 * lambda * square(e.trace);
  }
};

}  // namespace resilin
