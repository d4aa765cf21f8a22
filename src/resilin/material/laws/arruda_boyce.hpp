#pragma once

#include <array>

#include "resilin/material/hooke.hpp"
#include "resilin/material/invariants.hpp"
#include "resilin/material/law_text.hpp"

namespace resilin {

/// Rubber as a network of eight chains of N segments: the first five terms of the inverse Langevin series.
///
///   Psi = mu (1/2 (I - 3) + 1/(20 N) (I^2 - 9) + 11/(1050 N^2) (I^3 - 27) + 19/(7000 N^3) (I^4 - 81)
///             + 519/(673750 N^4) (I^5 - 243)) + kappa/2 (J - 1)^2,  I = I_C_bar
///
/// Every I^n - 3^n is x = I - 3 times a polynomial in x, so nothing cancels near rest.
template <class Real = double>
struct ArrudaBoyce {
  static constexpr LawKind kind = LawKind::invariants;
  static constexpr std::string_view name = "arruda_boyce";
  static constexpr std::string_view title = "Arruda-Boyce";
  static constexpr std::string_view formula =
      "mu ((I - 3)/2 + (I^2 - 9)/(20 N) + 11 (I^3 - 27)/(1050 N^2) + 19 (I^4 - 81)/(7000 N^3) + 519 (I^5 - "
      "243)/(673750 N^4)) + kappa/2 (J - 1)^2, I = J^(-2/3) I_C";
  static constexpr std::string_view source = "Arruda & Boyce 1993, eq. 22";
  static constexpr std::string_view inversion = "energy is infinite at J <= 0";
  static constexpr bool needs_positive_J = true;
  static constexpr bool uses_second_invariant = false;
  static constexpr std::array constants = {
      ConstantText{.name = "chain_modulus", .unit = "Pa", .meaning = "mu", .above = 0},
      ConstantText{.name = "chain_segments",
                   .unit = "",
                   .meaning = "N",
                   .above = 0,
                   .is_free = true,
                   .fallback = 26.5},
      bulk_modulus_text};

  Real mu;     // mu of the chains [Pa]
  Real N;      // segments of a chain
  Real kappa;  // bulk modulus [Pa]

  /// The small-strain shear modulus is mu (1 + 3/(5 N) + 99/(175 N^2) + 513/(875 N^3) + 42039/(67375 N^4)).
  static ArrudaBoyce from(const Hooke& hooke, double N) {
    const double r = 1 / N;
    const double stiffening =
        1 + r * (3.0 / 5 + r * (99.0 / 175 + r * (513.0 / 875 + r * (42039.0 / 67375))));
    return {hooke.mu / stiffening, N, hooke.bulk_modulus()};
  }

  /// The part that depends on J alone and resists changes of volume [J/m^3]; j = J - 1.
  template <class T>
  T volume_energy(const T& j) const {
    return 0.5 * kappa * square(j);
  }

  template <class T>
  T energy_density(const Invariants<T>& c) const {
    const T x = isochoric_first_invariant(c);
    const Real r = reciprocal(N);
    const T fifth = 405.0 + x * (270.0 + x * (90.0 + x * (15.0 + x)));
    const T fourth = 108.0 + x * (54.0 + x * (12.0 + x));
    const T third = 27.0 + x * (9.0 + x);
    const T series =
        0.5 + r * ((1.0 / 20) * (6.0 + x) +
                   r * ((11.0 / 1050) * third + r * ((19.0 / 7000) * fourth + (519.0 / 673750) * r * fifth)));
    return mu * (x * series) + volume_energy(c.j);
  }
};

}  // namespace resilin
