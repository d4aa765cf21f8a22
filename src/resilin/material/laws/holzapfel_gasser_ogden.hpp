#pragma once

#include <array>

#include "resilin/material/hooke.hpp"
#include "resilin/material/invariants.hpp"
#include "resilin/material/law_text.hpp"

namespace resilin {

/// Arterial tissue: a Neo-Hookean ground substance with one or two families of fibres of rest direction a,
/// which bear tension alone. Young and Poisson mean the ground substance.
///
///   Psi = mu/2 (I_C_bar - 3) + k1/(2 k2) sum_a (exp(k2 <E_a>^2) - 1) + kappa/2 (J - 1)^2
///   E_a = kd I_C_bar + (1 - 3 kd) J^(-2/3) |F a|^2 - 1,  <x> = max(x, 0)
template <class Real = double>
struct HolzapfelGasserOgden {
  static constexpr LawKind kind = LawKind::fibres;
  static constexpr std::string_view name = "holzapfel_gasser_ogden";
  static constexpr std::string_view title = "Holzapfel-Gasser-Ogden";
  static constexpr std::string_view formula =
      "mu/2 (I - 3) + k1/(2 k2) sum_a (exp(k2 <E_a>^2) - 1) + kappa/2 (J - 1)^2, I = J^(-2/3) I_C, E_a = kd "
      "I + (1 - 3 kd) J^(-2/3) |F a|^2 - 1, <x> = max(x, 0)";
  static constexpr std::string_view source = "Gasser, Ogden & Holzapfel 2006, eq. 4.6";
  static constexpr std::string_view inversion = "energy is infinite at J <= 0";
  static constexpr bool needs_positive_J = true;
  static constexpr bool uses_second_invariant = false;
  static constexpr int max_fibres = max_fibre_families;
  static constexpr std::array constants = {
      shear_modulus_text, bulk_modulus_text,
      ConstantText{.name = "fibre_modulus", .unit = "Pa", .meaning = "k1", .at_least = 0, .is_free = true},
      ConstantText{.name = "fibre_stiffening", .unit = "", .meaning = "k2", .above = 0, .is_free = true},
      ConstantText{.name = "dispersion",
                   .unit = "",
                   .meaning = "kd",
                   .at_least = 0,
                   .at_most = 1.0 / 3,
                   .is_free = true,
                   .fallback = 0}};

  Real mu;     // mu of the ground substance [Pa]
  Real kappa;  // bulk modulus [Pa]
  Real k1;     // [Pa]
  Real k2;     // pure number
  Real kd;     // dispersion, 0 for parallel fibres to 1/3

  static HolzapfelGasserOgden from(const Hooke& hooke, double k1, double k2, double kd) {
    return {hooke.mu, hooke.bulk_modulus(), k1, k2, kd};
  }

  /// The part that depends on J alone and resists changes of volume [J/m^3]; j = J - 1.
  template <class T>
  T volume_energy(const T& j) const {
    return 0.5 * kappa * square(j);
  }

  template <class T>
  T energy_density(const FibreInvariants<T>& c) const {
    const T shape = isochoric_first_invariant(c);
    T psi = 0.5 * mu * shape + volume_energy(c.j);
    for (int a = 0; a < max_fibre_families; ++a) {
      const T strain = kd * shape + (1.0 - 3.0 * kd) * isochoric_fibre_stretch(c, c.stretch[a]);
      psi = psi + (0.5 * k1 / k2 * c.weight[a]) * expm1(k2 * square_of_positive_part(strain));
    }
    return psi;
  }
};

}  // namespace resilin
