#pragma once

#include <array>

#include "resilin/material/hooke.hpp"
#include "resilin/material/invariants.hpp"
#include "resilin/material/law_text.hpp"

namespace resilin {

/// Heart muscle: fibres along the first direction in a tissue that is isotropic across them. Young and
/// Poisson mean the shear and the volume across the fibres.
///
///   Psi = c/2 (e^Q - 1) + kappa/2 (J - 1)^2, E_bar = (J^(-2/3) C - I)/2
///   Q = b_f E_ff^2 + b_t (E_ss^2 + E_nn^2 + 2 E_sn^2) + 2 b_fs (E_fs^2 + E_fn^2)
template <class Real = double>
struct Guccione {
  static constexpr LawKind kind = LawKind::axes;
  static constexpr std::string_view name = "guccione";
  static constexpr std::string_view title = "Guccione";
  static constexpr std::string_view formula =
      "c/2 (exp(Q) - 1) + kappa/2 (J - 1)^2, Q = b_f E_11^2 + b_t (E_22^2 + E_33^2 + 2 E_23^2) + 2 b_fs "
      "(E_12^2 + "
      "E_31^2), E = (J^(-2/3) F^T F - I)/2";
  static constexpr std::string_view source = "Guccione, Costa & McCulloch 1995";
  static constexpr std::string_view inversion = "energy is infinite at J <= 0";
  static constexpr bool needs_positive_J = true;
  static constexpr bool uses_second_invariant = false;
  static constexpr int max_fibres = 1;
  static constexpr ConstantText factor(std::string_view name, std::string_view meaning) {
    return {.name = name, .unit = "", .meaning = meaning, .above = 0};
  }
  static constexpr std::array constants = {ConstantText{"fung_modulus", "Pa", "c", 0},
                                           factor("fibre_factor", "b_f"), factor("transverse_factor", "b_t"),
                                           factor("fibre_shear_factor", "b_fs"), bulk_modulus_text};

  Real c0;              // [Pa]
  Real b_f, b_t, b_fs;  // pure numbers
  Real kappa;           // bulk modulus [Pa]

  /// The same in all directions.
  static Guccione from(const Hooke& hooke) { return {20 * hooke.mu, 0.1, 0.1, 0.1, hooke.bulk_modulus()}; }

  /// The part that depends on J alone and resists changes of volume [J/m^3]; j = J - 1.
  template <class T>
  T volume_energy(const T& j) const {
    return 0.5 * kappa * square(j);
  }

  template <class T>
  T energy_density(const AxesStrain<T>& c) const {
    const AxesStrain<T> e = isochoric_strain(c);
    const T Q = b_f * square(e.e11) + b_t * (square(e.e22) + square(e.e33) + 2.0 * square(e.e23)) +
                (2.0 * b_fs) * (square(e.e12) + square(e.e31));
    return (0.5 * c0) * expm1(Q) + volume_energy(c.j);
  }
};

}  // namespace resilin
