#pragma once

#include <cmath>
#include <random>
#include <vector>

#include "resilin/core/types.hpp"
#include "resilin/material/derive.hpp"
#include "sample_fibres.hpp"

namespace resilin::testing {

/// Small-strain constants that every test of laws uses: E = 100 kPa, nu = 0.3.
inline Hooke sample_hooke() { return hooke_from_young_poisson(1e5, 0.3); }

/// A law for a solid, with all the families of fibres that it can have.
inline Material material_for(const LawInfo& law, const Hooke& hooke) {
  return {&law, law.constants_from(hooke), fibres_for(law, {Vector3(0.8, 0.6, 0), Vector3(0.8, -0.6, 0)})};
}

inline Material sample_material(const LawInfo& law) { return material_for(law, sample_hooke()); }

/// The small-strain solid that the law can be: that of sample_hooke, unless it has but one Poisson's ratio.
inline Hooke hooke_of(const LawInfo& law) {
  const double mu = sample_hooke().mu, nu = law.only_poissons_ratio;
  return std::isnan(nu) ? sample_hooke() : Hooke{mu, 2 * mu * nu / (1 - 2 * nu)};
}

template <int dim>
Matrix<dim> random_matrix(std::mt19937& random) {
  std::normal_distribution<double> normal;
  Matrix<dim> A;
  for (int i = 0; i < dim * dim; ++i) A(i) = normal(random);
  return A;
}

template <int dim>
Matrix<dim> random_rotation(std::mt19937& random) {
  Matrix<dim> Q = random_matrix<dim>(random).householderQr().householderQ();
  if (Q.determinant() < 0) Q.col(0) *= -1;
  return Q;
}

/// Displacement gradients of moderate size with J > 0.1; for laws that allow it also inverted and flat ones,
/// and some with equal singular values.
template <int dim>
std::vector<Matrix<dim>> sample_gradients(const LawInfo& law, int count = 40) {
  std::mt19937 random(7);
  const Matrix<dim> I = Matrix<dim>::Identity();
  std::vector<Matrix<dim>> samples;
  while (static_cast<int>(samples.size()) < count) {
    const Matrix<dim> H = 0.35 * random_matrix<dim>(random);
    const double J = (I + H).determinant();
    if (J > 0.1 || (!law.needs_positive_J && samples.size() % 2 == 0)) samples.push_back(H);
  }
  Matrix<dim> equal = 0.2 * I;
  equal(0, 0) = -0.3;
  samples.push_back(equal);
  // Where fibres begin to bear load their laws have but one derivative.
  if (law.max_fibres > 0) return samples;
  samples.push_back(Matrix<dim>::Zero());
  samples.push_back(0.2 * I);
  samples.push_back(1.3 * random_rotation<dim>(random) - I);
  if (!law.needs_positive_J && law.kind != LawKind::stretches) {  // those know no rotation there
    samples.push_back(-I);
    samples.push_back(-1.5 * I);
  }
  return samples;
}

}  // namespace resilin::testing
