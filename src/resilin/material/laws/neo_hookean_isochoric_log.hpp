#pragma once

#include <array>

#include "resilin/material/hooke.hpp"
#include "resilin/material/invariants.hpp"
#include "resilin/material/law_text.hpp"

namespace resilin {

/// Neo-Hookean solid split into shape and volume, with the volumetric energy of FEBio's uncoupled materials.
///
///   Psi = mu/2 (J^(-2/3) I_C - 3) + kappa/2 (ln J)^2
template <class Real = double>
struct NeoHookeanIsochoricLog {
  static constexpr LawKind kind = LawKind::invariants;
  static constexpr std::string_view name = "neo_hookean_isochoric_log";
  static constexpr std::string_view title = "Neo-Hookean isochoric, logarithmic";
  static constexpr std::string_view formula = "mu/2 (J^(-2/3) I_C - 3) + kappa/2 (ln J)^2";
  static constexpr std::string_view source = "Simo, Taylor & Pister 1985";
  static constexpr std::string_view inversion = "energy is infinite at J <= 0; softens beyond J = e";
  static constexpr bool needs_positive_J = true;
  static constexpr bool uses_second_invariant = false;
  static constexpr std::array constants = {shear_modulus_text, bulk_modulus_text};

  Real mu;     // shear modulus [Pa]
  Real kappa;  // bulk modulus [Pa]

  static NeoHookeanIsochoricLog from(const Hooke& hooke) { return {hooke.mu, hooke.bulk_modulus()}; }

  /// The part that depends on J alone and resists changes of volume [J/m^3]; j = J - 1.
  template <class T>
  T volume_energy(const T& j) const {
    return 0.5 * kappa * square(log1p(j));
  }

  template <class T>
  T energy_density(const Invariants<T>& c) const {
    return 0.5 * mu * isochoric_first_invariant(c) + volume_energy(c.j);
  }
};

}  // namespace resilin
