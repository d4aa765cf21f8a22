#pragma once

#include <array>

#include "resilin/material/hooke.hpp"
#include "resilin/material/invariants.hpp"
#include "resilin/material/law_text.hpp"
#include "resilin/material/orthotropic_stiffness.hpp"

namespace resilin {

/// Hooke's law in the Green strain with moduli of each of three perpendicular axes. The first two are the
/// directions.
///
///   Psi = 1/2 E:C:E, E = (C - I)/2
template <class Real = double>
struct Orthotropic {
  static constexpr LawKind kind = LawKind::axes;
  static constexpr std::string_view name = "orthotropic";
  static constexpr std::string_view title = "Orthotropic";
  static constexpr std::string_view formula =
      "1/2 E:C:E, E = (F^T F - I)/2; C is the inverse of the compliances 1/E_i, -n_ij/E_i, 1/G_ij";
  static constexpr std::string_view source = "Lekhnitskii 1963; Bower 2009, sec. 3.2.13";
  static constexpr std::string_view inversion = "finite for every F; an inverted cell can stay inverted";
  static constexpr bool needs_positive_J = false;
  static constexpr bool uses_second_invariant = false;
  static constexpr int max_fibres = 2;
  static constexpr std::array constants = {
      ConstantText{"youngs_modulus_1", "Pa", "E_1", 0},  ConstantText{"youngs_modulus_2", "Pa", "E_2", 0},
      ConstantText{"youngs_modulus_3", "Pa", "E_3", 0},  ConstantText{"shear_modulus_12", "Pa", "G_12", 0},
      ConstantText{"shear_modulus_23", "Pa", "G_23", 0}, ConstantText{"shear_modulus_31", "Pa", "G_31", 0},
      ConstantText{"poissons_ratio_12", "", "n_12"},     ConstantText{"poissons_ratio_23", "", "n_23"},
      ConstantText{"poissons_ratio_31", "", "n_31"}};

  Real E1, E2, E3;     // [Pa]
  Real G12, G23, G31;  // [Pa]
  Real n12, n23, n31;  // n_ij: contraction along axis j of a pull along axis i

  static Orthotropic from(const Hooke& hooke) {
    const double E = hooke.youngs_modulus(), n = hooke.poissons_ratio();
    return {E, E, E, hooke.mu, hooke.mu, hooke.mu, n, n, n};
  }

  template <class T>
  T energy_density(const AxesStrain<T>& c) const {
    const OrthotropicConstants<Real> all = {E1, E2, E3, G12, G23, G31, n12, n23, n31};
    return 0.5 * twice_orthotropic_energy(all, c);
  }
};

}  // namespace resilin
