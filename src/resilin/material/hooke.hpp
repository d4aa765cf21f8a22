#pragma once

namespace resilin {

/// The two constants of the isotropic small-strain solid: sigma = 2 mu eps + lambda tr(eps) I.
struct Hooke {
  double mu;      ///< shear modulus [Pa]
  double lambda;  ///< Lame's lambda [Pa]

  double bulk_modulus() const { return lambda + 2 * mu / 3; }
  double youngs_modulus() const { return mu * (3 * lambda + 2 * mu) / (lambda + mu); }
  double poissons_ratio() const { return lambda / (2 * (lambda + mu)); }
};

/// Lame's constants [Pa] of Young's modulus [Pa] and Poisson's ratio in (-1, 0.5).
inline Hooke hooke_from_young_poisson(double youngs_modulus, double poissons_ratio) {
  return {youngs_modulus / (2 * (1 + poissons_ratio)),
          youngs_modulus * poissons_ratio / ((1 + poissons_ratio) * (1 - 2 * poissons_ratio))};
}

}  // namespace resilin
