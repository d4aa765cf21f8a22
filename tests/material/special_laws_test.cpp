// Closed forms of single laws.
#include <gtest/gtest.h>

#include <cmath>

#include "resilin/material/derive.hpp"

namespace resilin {
namespace {

Material material(const char* law, std::vector<double> constants, std::vector<Vector3> fibres = {}) {
  return {find_law(law), std::move(constants), std::move(fibres)};
}

Matrix<3> diagonal(double a, double b, double c) { return Vector3(a, b, c).asDiagonal(); }

Matrix<3> simple_shear(double g) {
  Matrix<3> F = Matrix<3>::Identity();
  F(0, 1) = g;
  return F;
}

/// P_12 of an isotropic law in simple shear is 2 g (W_1 + W_2), I_C = II_C = 3 + g^2.
TEST(VerondaWestmann, IsTheTextbookSolidInSimpleShear) {
  const double c1 = 3, c2 = 0.7, g = 0.8;
  const Matrix<3> P =
      first_piola_kirchhoff_stress<3>(material("veronda_westmann", {c1, c2, 50}), simple_shear(g));
  EXPECT_NEAR(P(0, 1), 2 * g * c1 * c2 * (std::exp(c2 * g * g) - 0.5), 1e-12);
}

/// Confined compression to the stretch l: I_C = 2 + l^2, II_C = 1 + 2 l^2, J = l.
TEST(HolmesMow, IsTheTextbookSolidInConfinedCompression) {
  const double mu = 2, lambda = 1.5, b = 0.6, l = 0.7, M = lambda + 2 * mu;
  const double Q = b / M * ((2 * mu - lambda) * (l * l - 1) + lambda * (2 * l * l - 2) - 2 * M * std::log(l));
  const double slope = b / M * (2 * (2 * mu - lambda) * l + 4 * lambda * l - 2 * M / l);
  const Matrix<3> P =
      first_piola_kirchhoff_stress<3>(material("holmes_mow", {mu, lambda, b}), diagonal(l, 1, 1));
  EXPECT_NEAR(P(0, 0), M / (4 * b) * std::exp(Q) * slope, 1e-12);
}

/// The Kirchhoff stresses are 2 mu ln s_i + lambda ln J.
TEST(Hencky, IsHookesLawInTheLogarithms) {
  const double mu = 2, lambda = 3;
  const Vector3 s(1.5, 0.8, 1.1);
  const Matrix<3> P =
      first_piola_kirchhoff_stress<3>(material("hencky", {mu, lambda}), diagonal(s[0], s[1], s[2]));
  for (int i = 0; i < 3; ++i)
    EXPECT_NEAR(P(i, i) * s[i], 2 * mu * std::log(s[i]) + lambda * std::log(s.prod()), 1e-13);
}

TEST(NeoHookeanIsochoricLog, HasTheLogarithmAsPressure) {
  const double kappa = 40, s = 1.1, J = s * s * s;
  const Material rubber = material("neo_hookean_isochoric_log", {2, kappa});
  const double pressure = cauchy_stress<3>(rubber, diagonal(s, s, s)).trace() / 3;
  EXPECT_NEAR(pressure, kappa * std::log(J) / J, 1e-12);
}

TEST(ExponentialFibre, AddsItsFibresToNeoHookean) {
  const double k1 = 3, k2 = 0.4, l = 1.3;
  const Matrix<3> F = diagonal(l, 0.9, 0.95);
  const double ground = energy_density<3>(material("neo_hookean", {2, 5}), F);
  for (const double n : {2.0, 2.5, 4.0}) {
    const Material tissue = material("exponential_fibre", {2, 5, k1, k2, n}, {Vector3::UnitX()});
    const double fibres = k1 / (k2 * n) * std::expm1(k2 * std::pow(l * l - 1, n));
    EXPECT_NEAR(energy_density<3>(tissue, F), ground + fibres, 1e-12);
    const Matrix<3> shortened = diagonal(0.9, 1.2, 1);
    EXPECT_NEAR(energy_density<3>(tissue, shortened),
                energy_density<3>(material("neo_hookean", {2, 5}), shortened), 1e-13);
  }
}

}  // namespace
}  // namespace resilin
