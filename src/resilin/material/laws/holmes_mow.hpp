#pragma once

#include <array>

#include "resilin/material/hooke.hpp"
#include "resilin/material/invariants.hpp"
#include "resilin/material/law_text.hpp"

namespace resilin {

/// Cartilage: a solid whose stiffness grows exponentially, at large compression too.
///
///   Psi = M/(4 b) (e^Q - 1), M = lambda + 2 mu
///   Q = b/M ((2 mu - lambda) (I_C - 3) + lambda (II_C - 3) - 2 M ln J)
///
/// In d1, d2 and j the bracket is (2 mu - lambda) d1 + lambda d2 - 2 M (ln J - j).
template <class Real = double>
struct HolmesMow {
  static constexpr LawKind kind = LawKind::invariants;
  static constexpr std::string_view name = "holmes_mow";
  static constexpr std::string_view title = "Holmes-Mow";
  static constexpr std::string_view formula =
      "M/(4 b) (exp(Q) - 1), M = lambda + 2 mu, Q = b/M ((2 mu - lambda) (I_C - 3) + lambda (II_C - 3) - 2 M "
      "ln J)";
  static constexpr std::string_view source = "Holmes & Mow 1990";
  static constexpr std::string_view inversion = "energy is infinite at J <= 0";
  static constexpr bool needs_positive_J = true;
  static constexpr bool uses_second_invariant = true;
  static constexpr std::array constants = {
      shear_modulus_text, lame_lambda_text,
      ConstantText{.name = "stiffening", .unit = "", .meaning = "b", .above = 0, .is_free = true}};

  Real mu;      // shear modulus [Pa]
  Real lambda;  // Lame's lambda [Pa]
  Real b;       // pure number

  static HolmesMow from(const Hooke& hooke, double b) { return {hooke.mu, hooke.lambda, b}; }

  template <class T>
  T energy_density(const Invariants<T>& c) const {
    const Real M = lambda + 2.0 * mu, share = b / M;
    const T Q = (share * (2.0 * mu - lambda)) * c.d1 + (share * lambda) * c.d2 - (2.0 * b) * log1p_minus(c.j);
    return (0.25 * M / b) * expm1(Q);
  }
};

}  // namespace resilin
