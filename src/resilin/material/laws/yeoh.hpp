#pragma once

#include <array>

#include "resilin/material/hooke.hpp"
#include "resilin/material/invariants.hpp"
#include "resilin/material/law_text.hpp"

namespace resilin {

/// Rubber that stiffens at large strain, a cubic in the first invariant. From Young and Poisson: c20 and c30
/// in about the ratios of Treloar's rubber.
///
///   Psi = c10 x + c20 x^2 + c30 x^3 + kappa/2 (J - 1)^2, x = I_C_bar - 3
template <class Real = double>
struct Yeoh {
  static constexpr LawKind kind = LawKind::invariants;
  static constexpr std::string_view name = "yeoh";
  static constexpr std::string_view title = "Yeoh";
  static constexpr std::string_view formula =
      "c10 x + c20 x^2 + c30 x^3 + kappa/2 (J - 1)^2, x = J^(-2/3) I_C - 3";
  static constexpr std::string_view source = "Yeoh 1993";
  static constexpr std::string_view inversion = "energy is infinite at J <= 0";
  static constexpr bool needs_positive_J = true;
  static constexpr bool uses_second_invariant = false;
  static constexpr std::array constants = {
      ConstantText{.name = "c10", .unit = "Pa", .meaning = "c10", .above = 0},
      ConstantText{.name = "c20", .unit = "Pa", .meaning = "c20", .fallback = 0},
      ConstantText{.name = "c30", .unit = "Pa", .meaning = "c30", .fallback = 0}, bulk_modulus_text};

  Real c10;    // half the shear modulus [Pa]
  Real c20;    // [Pa]
  Real c30;    // [Pa]
  Real kappa;  // bulk modulus [Pa]

  /// With these ratios dPsi/dx stays positive for every x.
  static Yeoh from(const Hooke& hooke) {
    const double c10 = 0.5 * hooke.mu;
    return {c10, -0.01 * c10, 0.0002 * c10, hooke.bulk_modulus()};
  }

  /// The part that depends on J alone and resists changes of volume [J/m^3]; j = J - 1.
  template <class T>
  T volume_energy(const T& j) const {
    return 0.5 * kappa * square(j);
  }

  template <class T>
  T energy_density(const Invariants<T>& c) const {
    const T x = isochoric_first_invariant(c);
    return c10 * x + c20 * square(x) + c30 * (square(x) * x) + volume_energy(c.j);
  }
};

}  // namespace resilin
