// Closed forms of single laws.
#include <gtest/gtest.h>

#include <cmath>

#include "resilin/material/derive.hpp"

namespace resilin {
namespace {

Material material(const char* law, std::vector<double> constants) {
  return {find_law(law), std::move(constants), {}};
}

Matrix<3> diagonal(double a, double b, double c) { return Vector3(a, b, c).asDiagonal(); }

/// P_12 of an isotropic law in simple shear is 2 g (W_1 + W_2), I_C = II_C = 3 + g^2.
TEST(VerondaWestmann, IsTheTextbookSolidInSimpleShear) {
  const double c1 = 3, c2 = 0.7, g = 0.8;
  Matrix<3> F = Matrix<3>::Identity();
  F(0, 1) = g;
  const Matrix<3> P = first_piola_kirchhoff_stress<3>(material("veronda_westmann", {c1, c2, 50}), F);
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

TEST(NeoHookeanIsochoricLog, HasTheLogarithmAsPressure) {
  const double kappa = 40, s = 1.1, J = s * s * s;
  const Material rubber = material("neo_hookean_isochoric_log", {2, kappa});
  const double pressure = cauchy_stress<3>(rubber, diagonal(s, s, s)).trace() / 3;
  EXPECT_NEAR(pressure, kappa * std::log(J) / J, 1e-12);
}

}  // namespace
}  // namespace resilin
