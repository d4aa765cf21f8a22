#pragma once

#include <array>

#include "resilin/material/hooke.hpp"
#include "resilin/material/invariants.hpp"
#include "resilin/material/law_text.hpp"

namespace resilin {

/// Rubber by a polynomial of third order in both invariants without volume change.
///
///   Psi = sum_ij c_ij (I_C_bar - 3)^i (II_C_bar - 3)^j + kappa/2 (J - 1)^2, 1 <= i + j <= 3
template <class Real = double>
struct Polynomial {
  static constexpr LawKind kind = LawKind::invariants;
  static constexpr std::string_view name = "polynomial";
  static constexpr std::string_view title = "Polynomial";
  static constexpr std::string_view formula =
      "c10 x + c01 y + c20 x^2 + c11 x y + c02 y^2 + c30 x^3 + c21 x^2 y + c12 x y^2 + c03 y^3 + kappa/2 (J "
      "- "
      "1)^2, x = J^(-2/3) I_C - 3, y = J^(-4/3) II_C - 3";
  static constexpr std::string_view source = "Rivlin & Saunders 1951";
  static constexpr std::string_view inversion = "energy is infinite at J <= 0";
  static constexpr bool needs_positive_J = true;
  static constexpr bool uses_second_invariant = true;
  static constexpr ConstantText coefficient(std::string_view name) {
    return {.name = name, .unit = "Pa", .meaning = name, .fallback = 0};
  }
  static constexpr std::array constants = {ConstantText{"c10", "Pa", "c10"},
                                           coefficient("c01"),
                                           coefficient("c20"),
                                           coefficient("c11"),
                                           coefficient("c02"),
                                           coefficient("c30"),
                                           coefficient("c21"),
                                           coefficient("c12"),
                                           coefficient("c03"),
                                           bulk_modulus_text};

  Real c10, c01, c20, c11, c02, c30, c21, c12, c03;  // [Pa]; half the shear modulus is c10 + c01
  Real kappa;                                        // bulk modulus [Pa]

  /// The ratios of `mooney_rivlin`.
  static Polynomial from(const Hooke& hooke) {
    return {0.4 * hooke.mu, 0.1 * hooke.mu, 0, 0, 0, 0, 0, 0, 0, hooke.bulk_modulus()};
  }

  /// The part that depends on J alone and resists changes of volume [J/m^3]; j = J - 1.
  template <class T>
  T volume_energy(const T& j) const {
    return 0.5 * kappa * square(j);
  }

  template <class T>
  T energy_density(const Invariants<T>& c) const {
    const T x = isochoric_first_invariant(c), y = isochoric_second_invariant(c);
    const T xx = square(x), xy = x * y, yy = square(y);
    return c10 * x + c01 * y + c20 * xx + c11 * xy + c02 * yy + c30 * (xx * x) + c21 * (xx * y) +
           c12 * (x * yy) + c03 * (yy * y) + volume_energy(c.j);
  }
};

}  // namespace resilin
