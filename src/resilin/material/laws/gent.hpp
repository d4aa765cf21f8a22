#pragma once

#include <array>

#include "resilin/material/hooke.hpp"
#include "resilin/material/invariants.hpp"
#include "resilin/material/law_text.hpp"

namespace resilin {

/// Rubber whose chains have a limit: the energy is infinite where I_C_bar - 3 reaches J_m.
///
///   Psi = -mu/2 J_m ln(1 - (I_C_bar - 3)/J_m) + kappa/2 (J - 1)^2
template <class Real = double>
struct Gent {
  static constexpr LawKind kind = LawKind::invariants;
  static constexpr std::string_view name = "gent";
  static constexpr std::string_view title = "Gent";
  static constexpr std::string_view formula = "-mu/2 J_m ln(1 - (J^(-2/3) I_C - 3)/J_m) + kappa/2 (J - 1)^2";
  static constexpr std::string_view source = "Gent 1996, eq. 2";
  static constexpr std::string_view inversion = "energy is infinite at J <= 0";
  static constexpr std::string_view end_of_domain = "J^(-2/3) I_C - 3 reaches J_m";
  static constexpr bool needs_positive_J = true;
  static constexpr bool uses_second_invariant = false;
  static constexpr std::array constants = {
      shear_modulus_text,
      ConstantText{
          .name = "limit", .unit = "", .meaning = "J_m", .above = 0, .is_free = true, .fallback = 97.2},
      bulk_modulus_text};

  Real mu;     // shear modulus [Pa]
  Real J_m;    // largest I_C_bar - 3
  Real kappa;  // bulk modulus [Pa]

  static Gent from(const Hooke& hooke, double J_m) { return {hooke.mu, J_m, hooke.bulk_modulus()}; }

  /// Positive where the energy is finite.
  template <class T>
  T margin(const Invariants<T>& c) const {
    return J_m - isochoric_first_invariant(c);
  }

  /// The part that depends on J alone and resists changes of volume [J/m^3]; j = J - 1.
  template <class T>
  T volume_energy(const T& j) const {
    return 0.5 * kappa * square(j);
  }

  template <class T>
  T energy_density(const Invariants<T>& c) const {
    const T x = reciprocal(J_m) * isochoric_first_invariant(c);
    return volume_energy(c.j) - 0.5 * mu * J_m * log1p(-x);
  }
};

}  // namespace resilin
