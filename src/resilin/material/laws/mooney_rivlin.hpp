#pragma once

#include <array>

#include "resilin/material/hooke.hpp"
#include "resilin/material/invariants.hpp"
#include "resilin/material/law_text.hpp"

namespace resilin {

/// Rubber in both invariants. From Young and Poisson: c01 = c10 / 4.
///
///   Psi = c10 (I_C_bar - 3) + c01 (II_C_bar - 3) + kappa/2 (J - 1)^2
template <class Real = double>
struct MooneyRivlin {
  static constexpr LawKind kind = LawKind::invariants;
  static constexpr std::string_view name = "mooney_rivlin";
  static constexpr std::string_view title = "Mooney-Rivlin";
  static constexpr std::string_view formula =
      "c10 (J^(-2/3) I_C - 3) + c01 (J^(-4/3) II_C - 3) + kappa/2 (J - 1)^2";
  static constexpr std::string_view source = "Mooney 1940; Rivlin 1948; Bonet & Wood 2008, sec. 6.5";
  static constexpr std::string_view inversion = "energy is infinite at J <= 0";
  static constexpr bool needs_positive_J = true;
  static constexpr bool uses_second_invariant = true;
  static constexpr std::array constants = {ConstantText{.name = "c10", .unit = "Pa", .meaning = "c10"},
                                           ConstantText{.name = "c01", .unit = "Pa", .meaning = "c01"},
                                           bulk_modulus_text};

  Real c10;    // [Pa]
  Real c01;    // [Pa]
  Real kappa;  // bulk modulus [Pa]

  /// The small-strain shear modulus is 2 (c10 + c01).
  static MooneyRivlin from(const Hooke& hooke) {
    return {0.4 * hooke.mu, 0.1 * hooke.mu, hooke.bulk_modulus()};
  }

  /// The part that depends on J alone and resists changes of volume [J/m^3]; j = J - 1.
  template <class T>
  T volume_energy(const T& j) const {
    return 0.5 * kappa * square(j);
  }

  template <class T>
  T energy_density(const Invariants<T>& c) const {
    return c10 * isochoric_first_invariant(c) + c01 * isochoric_second_invariant(c) + volume_energy(c.j);
  }
};

}  // namespace resilin
