#pragma once

#include <array>

#include "resilin/material/hooke.hpp"
#include "resilin/material/invariants.hpp"
#include "resilin/material/law_text.hpp"
#include "resilin/material/orthotropic_stiffness.hpp"

namespace resilin {

/// Fung's exponential of an orthotropic quadratic form of the strain without volume change: arteries, skin.
///
///   Psi = c/2 (exp(E_bar:C:E_bar / c) - 1) + kappa/2 (J - 1)^2, E_bar = (J^(-2/3) C - I)/2
template <class Real = double>
struct FungOrthotropic {
  static constexpr LawKind kind = LawKind::axes;
  static constexpr std::string_view name = "fung_orthotropic";
  static constexpr std::string_view title = "Fung orthotropic";
  static constexpr std::string_view formula =
      "c/2 (exp(E:C:E / c) - 1) + kappa/2 (J - 1)^2, E = (J^(-2/3) F^T F - I)/2; C is the inverse of the "
      "compliances "
      "1/E_i, -n_ij/E_i, 1/G_ij";
  static constexpr std::string_view source = "Fung, Fronek & Patitucci 1979; Ateshian & Costa 2009";
  static constexpr std::string_view inversion = "energy is infinite at J <= 0";
  static constexpr bool needs_positive_J = true;
  static constexpr bool uses_second_invariant = false;
  static constexpr int max_fibres = 2;
  static constexpr std::array constants = {ConstantText{"youngs_modulus_1", "Pa", "E_1", 0},
                                           ConstantText{"youngs_modulus_2", "Pa", "E_2", 0},
                                           ConstantText{"youngs_modulus_3", "Pa", "E_3", 0},
                                           ConstantText{"shear_modulus_12", "Pa", "G_12", 0},
                                           ConstantText{"shear_modulus_23", "Pa", "G_23", 0},
                                           ConstantText{"shear_modulus_31", "Pa", "G_31", 0},
                                           ConstantText{"poissons_ratio_12", "", "n_12"},
                                           ConstantText{"poissons_ratio_23", "", "n_23"},
                                           ConstantText{"poissons_ratio_31", "", "n_31"},
                                           ConstantText{"fung_modulus", "Pa", "c", 0},
                                           bulk_modulus_text};

  Real E1, E2, E3;     // [Pa]
  Real G12, G23, G31;  // [Pa]
  Real n12, n23, n31;  // n_ij: contraction along axis j of a pull along axis i
  Real c0;             // [Pa]; the smaller, the sooner the stiffness grows
  Real kappa;          // bulk modulus [Pa]

  /// The trace of E_bar is of second order, so that any n_ij would do.
  static FungOrthotropic from(const Hooke& hooke) {
    const double E = 2 * hooke.mu;
    return {E, E, E, hooke.mu, hooke.mu, hooke.mu, 0, 0, 0, 20 * hooke.mu, hooke.bulk_modulus()};
  }

  /// The part that depends on J alone and resists changes of volume [J/m^3]; j = J - 1.
  template <class T>
  T volume_energy(const T& j) const {
    return 0.5 * kappa * square(j);
  }

  template <class T>
  T energy_density(const AxesStrain<T>& c) const {
    const OrthotropicConstants<Real> all = {E1, E2, E3, G12, G23, G31, n12, n23, n31};
    const T twice = twice_orthotropic_energy(all, isochoric_strain(c));
    return (0.5 * c0) * expm1(reciprocal(c0) * twice) + volume_energy(c.j);
  }
};

}  // namespace resilin
