#pragma once

#include <array>

#include "resilin/material/hooke.hpp"
#include "resilin/material/invariants.hpp"
#include "resilin/material/law_text.hpp"
#include "resilin/material/orthotropic_stiffness.hpp"

namespace resilin {

/// Hooke's law in the Green strain with other moduli along an axis than across it: unidirectional composites,
/// wood, tendons at small strain. The axis is the first direction.
///
///   Psi = 1/2 E:C:E, E = (C - I)/2
template <class Real = double>
struct TransverselyIsotropic {
  static constexpr LawKind kind = LawKind::axes;
  static constexpr std::string_view name = "transversely_isotropic";
  static constexpr std::string_view title = "Transversely isotropic";
  static constexpr std::string_view formula =
      "1/2 E:C:E, E = (F^T F - I)/2; C has E_a, n_a and G_a along the axis, E_t, n_t and E_t/(2 (1 + n_t)) "
      "across";
  static constexpr std::string_view source = "Lekhnitskii 1963; Bonet & Burton 1998";
  static constexpr std::string_view inversion = "finite for every F; an inverted cell can stay inverted";
  static constexpr bool needs_positive_J = false;
  static constexpr bool uses_second_invariant = false;
  static constexpr int max_fibres = 1;
  static constexpr std::array constants = {
      ConstantText{"axial_modulus", "Pa", "E_a", 0}, ConstantText{"transverse_modulus", "Pa", "E_t", 0},
      ConstantText{"axial_poissons_ratio", "", "n_a"}, ConstantText{"transverse_poissons_ratio", "", "n_t"},
      ConstantText{"axial_shear_modulus", "Pa", "G_a", 0}};

  Real E_a;  // [Pa]
  Real E_t;  // [Pa]
  Real n_a;  // contraction across a pull along the axis
  Real n_t;  // the same of a pull across it
  Real G_a;  // modulus of shear along the axis [Pa]

  static TransverselyIsotropic from(const Hooke& hooke) {
    const double E = hooke.youngs_modulus(), n = hooke.poissons_ratio();
    return {E, E, n, n, hooke.mu};
  }

  template <class T>
  T energy_density(const AxesStrain<T>& c) const {
    const Real G_t = E_t / (2.0 * (1.0 + n_t)), n31 = n_a * E_t / E_a;
    const OrthotropicConstants<Real> all = {E_a, E_t, E_t, G_a, G_t, G_a, n_a, n_t, n31};
    return 0.5 * twice_orthotropic_energy(all, c);
  }
};

}  // namespace resilin
