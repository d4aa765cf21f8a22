#pragma once

#include <array>

#include "resilin/material/hooke.hpp"
#include "resilin/material/law_text.hpp"
#include "resilin/material/stretches.hpp"

namespace resilin {

/// Hooke's law in the logarithmic strain: as stiff in compression as in tension, softer at large tension.
///
///   Psi = mu sum_i (ln s_i)^2 + lambda/2 (ln J)^2
template <class Real = double>
struct Hencky {
  static constexpr LawKind kind = LawKind::stretches;
  static constexpr std::string_view name = "hencky";
  static constexpr std::string_view title = "Hencky";
  static constexpr std::string_view formula = "mu sum_i (ln s_i)^2 + lambda/2 (ln J)^2";
  static constexpr std::string_view source = "Hencky 1928; Bonet & Wood 2008, eq. 6.94";
  static constexpr std::string_view inversion = "energy is infinite at J <= 0; softens beyond a stretch of e";
  static constexpr bool needs_positive_J = true;
  static constexpr bool uses_second_invariant = false;
  static constexpr std::array constants = {shear_modulus_text, lame_lambda_text};

  Real mu;      // shear modulus [Pa]
  Real lambda;  // Lame's lambda [Pa]

  static Hencky from(const Hooke& hooke) { return {hooke.mu, hooke.lambda}; }

  template <class T>
  T energy_density(const Stretches<T>& c) const {
    return mu * c.logarithm_square_sum() + 0.5 * lambda * square(log1p(c.j));
  }
};

}  // namespace resilin
