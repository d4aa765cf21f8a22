#pragma once

#include <array>

#include "resilin/material/hooke.hpp"
#include "resilin/material/invariants.hpp"
#include "resilin/material/law_text.hpp"

namespace resilin {

/// Neo-Hookean solid split into shape and volume, with a volume term that grows at both ends.
///
///   Psi = mu/2 (J^(-2/3) I_C - 3) + kappa/4 (J^2 - 1 - 2 ln J)
///
/// J^2 - 1 = j^2 + 2 j, so the volume term is kappa/4 (j^2 - 2 (ln(1 + j) - j)).
template <class Real = double>
struct NeoHookeanSimo {
  static constexpr LawKind kind = LawKind::invariants;
  static constexpr std::string_view name = "neo_hookean_simo";
  static constexpr std::string_view title = "Neo-Hookean Simo";
  static constexpr std::string_view formula = "mu/2 (J^(-2/3) I_C - 3) + kappa/4 (J^2 - 1 - 2 ln J)";
  static constexpr std::string_view source = "Simo & Miehe 1992; deal.II step-44";
  static constexpr std::string_view inversion = "energy is infinite at J <= 0";
  static constexpr bool needs_positive_J = true;
  static constexpr bool uses_second_invariant = false;
  static constexpr std::array constants = {shear_modulus_text, bulk_modulus_text};

  Real mu;     // shear modulus [Pa]
  Real kappa;  // bulk modulus [Pa]

  static NeoHookeanSimo from(const Hooke& hooke) { return {hooke.mu, hooke.bulk_modulus()}; }

  /// The part that depends on J alone and resists changes of volume [J/m^3]; j = J - 1.
  template <class T>
  T volume_energy(const T& j) const {
    return 0.25 * kappa * (square(j) - 2.0 * log1p_minus(j));
  }

  template <class T>
  T energy_density(const Invariants<T>& c) const {
    return 0.5 * mu * isochoric_first_invariant(c) + volume_energy(c.j);
  }
};

}  // namespace resilin
