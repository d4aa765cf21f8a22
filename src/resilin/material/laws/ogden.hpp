#pragma once

#include <array>

#include "resilin/material/hooke.hpp"
#include "resilin/material/law_text.hpp"
#include "resilin/material/stretches.hpp"

namespace resilin {

/// Rubber in powers of the stretches without volume change, l_i = J^(-1/3) s_i; three terms, of which those
/// with mu_p = 0 add nothing. From Young and Poisson: the ratios of Treloar's rubber (Ogden 1972).
///
///   Psi = sum_p mu_p/alpha_p (l_1^alpha_p + l_2^alpha_p + l_3^alpha_p - 3) + kappa/2 (J - 1)^2
template <class Real = double>
struct Ogden {
  static constexpr LawKind kind = LawKind::stretches;
  static constexpr std::string_view name = "ogden";
  static constexpr std::string_view title = "Ogden";
  static constexpr std::string_view formula =
      "sum_p mu_p/alpha_p (l_1^alpha_p + l_2^alpha_p + l_3^alpha_p - 3) + kappa/2 (J - 1)^2, l_i = J^(-1/3) "
      "s_i";
  static constexpr std::string_view source = "Ogden 1972; Holzapfel 2000, eq. 6.139";
  static constexpr std::string_view inversion = "energy is infinite at J <= 0";
  static constexpr bool needs_positive_J = true;
  static constexpr bool uses_second_invariant = false;
  static constexpr std::array constants = {
      ConstantText{.name = "mu_1", .unit = "Pa", .meaning = "mu_1"},
      ConstantText{.name = "alpha_1", .unit = "", .meaning = "alpha_1", .is_nonzero = true},
      ConstantText{.name = "mu_2", .unit = "Pa", .meaning = "mu_2", .fallback = 0},
      ConstantText{.name = "alpha_2", .unit = "", .meaning = "alpha_2", .is_nonzero = true, .fallback = 2},
      ConstantText{.name = "mu_3", .unit = "Pa", .meaning = "mu_3", .fallback = 0},
      ConstantText{.name = "alpha_3", .unit = "", .meaning = "alpha_3", .is_nonzero = true, .fallback = -2},
      bulk_modulus_text};

  Real mu_1;     // [Pa]
  Real alpha_1;  // exponent
  Real mu_2;     // [Pa]
  Real alpha_2;  // exponent
  Real mu_3;     // [Pa]
  Real alpha_3;  // exponent
  Real kappa;    // bulk modulus [Pa]

  /// The small-strain shear modulus is sum_p mu_p alpha_p / 2; Treloar's rubber has 0.4225 MPa.
  static Ogden from(const Hooke& hooke) {
    const double scale = hooke.mu / 0.4225;
    return {0.63 * scale, 1.3, 0.0012 * scale, 5.0, -0.01 * scale, -2.0, hooke.bulk_modulus()};
  }

  /// The part that depends on J alone and resists changes of volume [J/m^3]; j = J - 1.
  template <class T>
  T volume_energy(const T& j) const {
    return 0.5 * kappa * square(j);
  }

  template <class T>
  T energy_density(const Stretches<T>& c) const {
    return (mu_1 / alpha_1) * c.isochoric_power_sum(alpha_1) +
           (mu_2 / alpha_2) * c.isochoric_power_sum(alpha_2) +
           (mu_3 / alpha_3) * c.isochoric_power_sum(alpha_3) + volume_energy(c.j);
  }
};

}  // namespace resilin
