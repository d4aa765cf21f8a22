#pragma once

#include <array>

#include "resilin/material/hooke.hpp"
#include "resilin/material/law_text.hpp"
#include "resilin/material/stretches.hpp"

namespace resilin {

/// As rigid as possible: the distance to the nearest rotation. It does not know of volume, so its Poisson's
/// ratio is 0.
///
///   Psi = mu |F - R|^2
template <class Real = double>
struct Arap {
  static constexpr LawKind kind = LawKind::stretches;
  static constexpr std::string_view name = "arap";
  static constexpr std::string_view title = "ARAP";
  static constexpr std::string_view formula = "mu |F - R|^2, F = R S";
  static constexpr std::string_view source = "Sorkine & Alexa 2007; Kim & Eberle 2022, ch. 5";
  static constexpr std::string_view inversion =
      "finite; R is not unique, and nothing is returned, where the two smallest signed stretches cancel";
  static constexpr bool needs_positive_J = false;
  static constexpr bool uses_second_invariant = false;
  static constexpr std::array constants = {shear_modulus_text};

  Real mu;  // shear modulus [Pa]

  static constexpr double only_poissons_ratio = 0;
  static Arap from(const Hooke& hooke) { return {hooke.mu}; }

  template <class T>
  T energy_density(const Stretches<T>& c) const {
    return mu * c.square;
  }
};

}  // namespace resilin
