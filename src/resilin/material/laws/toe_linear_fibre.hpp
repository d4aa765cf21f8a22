#pragma once

#include <array>

#include "resilin/material/hooke.hpp"
#include "resilin/material/invariants.hpp"
#include "resilin/material/law_text.hpp"

namespace resilin {

namespace detail {

/// Integral of (e^(c x) - 1) / (1 + x) from 0 to s >= 0: an exponential integral, here by Gauss quadrature
/// with 12 points. It is exact to round-off for c s <= 20 and s <= 1.
template <class Real>
RESILIN_DUAL_INLINE Real toe_integral(const Real& s, const Real& c) {
  constexpr double offsets[6] = {0.06261670425573446, 0.18391574949909009, 0.29365897714330874,
                                 0.38495133709715235, 0.45205862818523740, 0.49078031712335962};
  constexpr double weights[6] = {0.12457352290670134, 0.11674626826917732, 0.10158371336153282,
                                 0.08003916427167306, 0.05346966299765944, 0.02358766819325601};
  Real sum = 0.0 * s;
  for (int i = 0; i < 6; ++i)
    for (const double side : {-1.0, 1.0}) {
      const Real x = (0.5 + side * offsets[i]) * s;
      sum = sum + weights[i] * (expm1(c * x) * (1.0 / (1.0 + x)));
    }
  return s * sum;
}

/// The same with derivatives with respect to s.
template <IsDual T>
RESILIN_DUAL_INLINE T toe_energy(const T& s, const typename T::Number& c) {
  const auto r = 1.0 / (1.0 + s.value);
  const auto f1 = expm1(c * s.value) * r;
  return T::chain(s, toe_integral(s.value, c), f1, (c * exp(c * s.value) - f1) * r);
}

}  // namespace detail

/// Ligaments and tendons: crimped fibres of rest direction a that stiffen exponentially and then,
/// straightened, linearly. They bear tension alone, in a Neo-Hookean ground substance. Young and Poisson mean
/// the latter.
///
///   Psi = mu/2 (I_C_bar - 3) + sum_a W(l_a) + kappa/2 (J - 1)^2,  l_a = J^(-1/3) |F a|
///   l W'(l) = 0 for l < 1,  c3 (exp(c4 (l - 1)) - 1) up to l_m,  c5 l + c6 beyond
///
/// W' is continuous by c6. With s = l - 1 the toe is `toe_energy`.
template <class Real = double>
struct ToeLinearFibre {
  static constexpr LawKind kind = LawKind::fibres;
  static constexpr std::string_view name = "toe_linear_fibre";
  static constexpr std::string_view title = "Toe-linear fibre";
  static constexpr std::string_view formula =
      "mu/2 (J^(-2/3) I_C - 3) + sum_a W(J^(-1/3) |F a|) + kappa/2 (J - 1)^2, l W'(l) = 0 for l < 1, "
      "c3 (exp(c4 (l - 1)) - 1) up to l_m, c5 l + c6 beyond; c6 makes W' continuous";
  static constexpr std::string_view source = "Weiss, Maker & Govindjee 1996, eq. 6.7";
  static constexpr std::string_view inversion = "energy is infinite at J <= 0";
  static constexpr bool needs_positive_J = true;
  static constexpr bool uses_second_invariant = false;
  static constexpr int max_fibres = max_fibre_families;
  static constexpr std::array constants = {
      shear_modulus_text,
      bulk_modulus_text,
      ConstantText{.name = "fibre_modulus", .unit = "Pa", .meaning = "c3", .at_least = 0, .is_free = true},
      ConstantText{.name = "fibre_stiffening", .unit = "", .meaning = "c4", .above = 0, .is_free = true},
      ConstantText{.name = "straight_modulus", .unit = "Pa", .meaning = "c5", .at_least = 0, .is_free = true},
      ConstantText{.name = "straight_stretch",
                   .unit = "",
                   .meaning = "l_m",
                   .above = 1,
                   .is_free = true,
                   .fallback = 1.05}};

  Real mu;     // mu of the ground substance [Pa]
  Real kappa;  // bulk modulus [Pa]
  Real c3;     // scale of the exponential [Pa]
  Real c4;     // rate at which the fibres straighten
  Real c5;     // modulus of straightened fibres [Pa]
  Real l_m;    // stretch at which they are straight

  static ToeLinearFibre from(const Hooke& hooke, double c3, double c4, double c5, double l_m) {
    return {hooke.mu, hooke.bulk_modulus(), c3, c4, c5, l_m};
  }

  /// The part that depends on J alone and resists changes of volume [J/m^3]; j = J - 1.
  template <class T>
  T volume_energy(const T& j) const {
    return 0.5 * kappa * square(j);
  }

  template <class T>
  T energy_density(const FibreInvariants<T>& c) const {
    const Real m = l_m - 1.0, c6 = c3 * expm1(c4 * m) - c5 * l_m;
    T psi = 0.5 * mu * isochoric_first_invariant(c) + volume_energy(c.j);
    for (int a = 0; a < max_fibre_families; ++a) {
      const T s = expm1(0.5 * log1p(positive_part(isochoric_fibre_stretch(c, c.stretch[a]))));
      const T beyond = positive_part(-m + s);
      psi = psi + c.weight[a] * (c3 * detail::toe_energy(s - beyond, c4) + c5 * beyond +
                                 c6 * log1p((1.0 / l_m) * beyond));
    }
    return psi;
  }
};

}  // namespace resilin
