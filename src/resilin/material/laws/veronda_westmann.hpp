#pragma once

#include <array>

#include "resilin/material/hooke.hpp"
#include "resilin/material/invariants.hpp"
#include "resilin/material/law_text.hpp"

namespace resilin {

/// Soft tissue that stiffens exponentially.
///
///   Psi = c1 (exp(c2 (I_C_bar - 3)) - 1) - c1 c2/2 (II_C_bar - 3) + kappa/2 (J - 1)^2
template <class Real = double>
struct VerondaWestmann {
  static constexpr LawKind kind = LawKind::invariants;
  static constexpr std::string_view name = "veronda_westmann";
  static constexpr std::string_view title = "Veronda-Westmann";
  static constexpr std::string_view formula =
      "c1 (exp(c2 (J^(-2/3) I_C - 3)) - 1) - c1 c2/2 (J^(-4/3) II_C - 3) + kappa/2 (J - 1)^2";
  static constexpr std::string_view source = "Veronda & Westmann 1970";
  static constexpr std::string_view inversion = "energy is infinite at J <= 0";
  static constexpr bool needs_positive_J = true;
  static constexpr bool uses_second_invariant = true;
  static constexpr std::array constants = {
      ConstantText{.name = "c1", .unit = "Pa", .meaning = "c1", .above = 0},
      ConstantText{.name = "c2", .unit = "", .meaning = "c2", .above = 0, .is_free = true},
      bulk_modulus_text};

  Real c1;     // [Pa]; the shear modulus is c1 c2
  Real c2;     // pure number
  Real kappa;  // bulk modulus [Pa]

  static VerondaWestmann from(const Hooke& hooke, double c2) {
    return {hooke.mu / c2, c2, hooke.bulk_modulus()};
  }

  /// The part that depends on J alone and resists changes of volume [J/m^3]; j = J - 1.
  template <class T>
  T volume_energy(const T& j) const {
    return 0.5 * kappa * square(j);
  }

  template <class T>
  T energy_density(const Invariants<T>& c) const {
    return c1 * expm1(c2 * isochoric_first_invariant(c)) - (0.5 * c1 * c2) * isochoric_second_invariant(c) +
           volume_energy(c.j);
  }
};

}  // namespace resilin
