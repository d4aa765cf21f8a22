#pragma once

#include <array>

#include "resilin/core/dual_power.hpp"
#include "resilin/material/hooke.hpp"
#include "resilin/material/invariants.hpp"
#include "resilin/material/law_text.hpp"

namespace resilin {

/// One or two families of fibres of rest direction a, which bear tension alone, in a Neo-Hookean ground
/// substance. Young and Poisson mean the ground substance.
///
///   Psi = mu/2 (I_C - 3) - mu ln J + lambda/2 (ln J)^2
///         + k1/(k2 n) sum_a (exp(k2 <E_a>^n) - 1),  E_a = |F a|^2 - 1,  <x> = max(x, 0)
template <class Real = double>
struct ExponentialFibre {
  static constexpr LawKind kind = LawKind::fibres;
  static constexpr std::string_view name = "exponential_fibre";
  static constexpr std::string_view title = "Exponential fibre";
  static constexpr std::string_view formula =
      "mu/2 (I_C - 3) - mu ln J + lambda/2 (ln J)^2 + k1/(k2 n) sum_a (exp(k2 <E_a>^n) - 1), "
      "E_a = |F a|^2 - 1, <x> = max(x, 0)";
  static constexpr std::string_view source = "Lanir 1983; Ateshian et al. 2009";
  static constexpr std::string_view inversion = "energy is infinite at J <= 0";
  static constexpr bool needs_positive_J = true;
  static constexpr bool uses_second_invariant = false;
  static constexpr int max_fibres = max_fibre_families;
  static constexpr std::array constants = {
      shear_modulus_text, lame_lambda_text,
      ConstantText{.name = "fibre_modulus", .unit = "Pa", .meaning = "k1", .at_least = 0, .is_free = true},
      ConstantText{.name = "fibre_stiffening", .unit = "", .meaning = "k2", .above = 0, .is_free = true},
      ConstantText{
          .name = "fibre_power", .unit = "", .meaning = "n", .above = 1, .is_free = true, .fallback = 2}};

  Real mu;      // shear modulus of the ground substance [Pa]
  Real lambda;  // its Lame's lambda [Pa]
  Real k1;      // [Pa]
  Real k2;      // pure number
  Real n;       // exponent

  static ExponentialFibre from(const Hooke& hooke, double k1, double k2, double n) {
    return {hooke.mu, hooke.lambda, k1, k2, n};
  }

  template <class T>
  T energy_density(const FibreInvariants<T>& c) const {
    T psi = 0.5 * mu * c.d1 - mu * log1p_minus(c.j) + 0.5 * lambda * square(log1p(c.j));
    for (int a = 0; a < max_fibre_families; ++a)
      psi = psi + (k1 / (k2 * n) * c.weight[a]) * expm1(k2 * power_of_positive_part(c.stretch[a], n));
    return psi;
  }
};

}  // namespace resilin
