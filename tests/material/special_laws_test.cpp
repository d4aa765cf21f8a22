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

TEST(Polynomial, IsItsSeriesInSimpleShear) {
  const std::vector<double> c = {1, 0.3, -0.2, 0.07, 0.05, 0.011, 0.013, 0.017, 0.019, 100};
  const double g = 0.9, x = g * g;
  const double psi =
      (c[0] + c[1]) * x + (c[2] + c[3] + c[4]) * x * x + (c[5] + c[6] + c[7] + c[8]) * x * x * x;
  EXPECT_NEAR(energy_density<3>(material("polynomial", c), simple_shear(g)), psi, 1e-13);
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

/// At constant volume the Kirchhoff stress of the fibres along their axis is l W'(l), beside that of the
/// ground substance: nothing in compression, an exponential, then a line.
TEST(ToeLinearFibre, StiffensExponentiallyAndThenLinearly) {
  const double c3 = 3, c4 = 12, c5 = 150, l_m = 1.2;
  const Material tissue = material("toe_linear_fibre", {2, 50, c3, c4, c5, l_m}, {Vector3::UnitX()});
  const Material ground = material("neo_hookean_isochoric", {2, 50});
  for (const double l : {0.8, 1.05, 1.1999, 1.2001, 1.5}) {
    const Matrix<3> F = diagonal(l, 1 / std::sqrt(l), 1 / std::sqrt(l));
    const double toe = c3 * std::expm1(c4 * (std::min(l, l_m) - 1));
    const double expected = l < 1 ? 0 : toe + c5 * std::max(l - l_m, 0.0);
    const Matrix<3> more =
        first_piola_kirchhoff_stress<3>(tissue, F) - first_piola_kirchhoff_stress<3>(ground, F);
    // the deviator of a stress along x alone
    EXPECT_NEAR(more(0, 0) * l, 2.0 / 3 * expected, 1e-12 * (1 + expected)) << l;
    EXPECT_NEAR(more(1, 1) / std::sqrt(l), -1.0 / 3 * expected, 1e-12 * (1 + expected)) << l;
  }
  // The energy is the integral of W', by Simpson's rule.
  const auto fibre_energy = [&](double l) {
    const Matrix<3> F = diagonal(l, 1 / std::sqrt(l), 1 / std::sqrt(l));
    return energy_density<3>(tissue, F) - energy_density<3>(ground, F);
  };
  const int n = 2000;
  double integral = 0;
  for (int i = 0; i <= n; ++i) {
    const double l = 1 + 0.19 * i / n, weight = i == 0 || i == n ? 1 : i % 2 == 1 ? 4 : 2;
    integral += weight * 0.19 / (3 * n) * c3 * std::expm1(c4 * (l - 1)) / l;
  }
  EXPECT_NEAR(fibre_energy(1.19), integral, 1e-11);
  EXPECT_NEAR(fibre_energy(1.5) - fibre_energy(1.2),
              c5 * 0.3 + (c3 * std::expm1(c4 * 0.2) - c5 * l_m) * std::log(1.5 / 1.2), 1e-11);
}

/// Small strain: the compliances of a pull along each axis and of each shear.
TEST(Orthotropic, HasTheGivenModuliAlongItsAxes) {
  const std::vector<double> c = {1.0, 2.0, 3.0, 0.4, 0.5, 0.6, 0.3, 0.2, 0.1};
  const Vector3 first = Vector3(1, 2, 0).normalized(), across(1, 0, 1);  // made perpendicular to the first
  const Vector3 second = (across - across.dot(first) * first).normalized(), third = first.cross(second);
  const TangentMatrix<3> A = stress_tangent<3>(material("orthotropic", c, {first, across.normalized()}),
                                               Matrix<3>(Matrix<3>::Identity()));
  Matrix<3> axes;
  axes << first, second, third;
  const auto stress = [&](const Matrix<3>& strain) {  // in the axes
    const Matrix<3> eps = axes * strain * axes.transpose();
    const Eigen::Map<const Eigen::Matrix<double, 9, 1>> column(eps.data());
    const Eigen::Matrix<double, 9, 1> sigma = A * column;
    return Matrix<3>(axes.transpose() * Eigen::Map<const Matrix<3>>(sigma.data()) * axes);
  };
  const double n13 = c[8] * c[0] / c[2];  // n_31/E_3 = n_13/E_1
  const Matrix<3> pull = stress(diagonal(1, -c[6], -n13));
  EXPECT_LT((pull - diagonal(c[0], 0, 0)).norm(), 1e-13);
  EXPECT_LT((stress(diagonal(-c[6] * c[1] / c[0], 1, -c[7])) - diagonal(0, c[1], 0)).norm(), 1e-13);
  for (const auto& [i, k, G] : {std::tuple(0, 1, c[3]), std::tuple(1, 2, c[4]), std::tuple(2, 0, c[5])}) {
    Matrix<3> shear = Matrix<3>::Zero();
    shear(i, k) = shear(k, i) = 0.5;
    EXPECT_NEAR(stress(shear)(i, k), G, 1e-13);
  }
}

TEST(TransverselyIsotropic, IsOrthotropicWithTwoEqualAxes) {
  const double E_a = 10, E_t = 2, n_a = 0.3, n_t = 0.4, G_a = 1.5;
  const Vector3 axis = Vector3(1, 2, 3).normalized();
  Matrix<3> F = Matrix<3>::Identity();
  F << 1.2, 0.3, 0.1, -0.1, 0.9, 0.2, 0.05, -0.15, 1.1;
  const Material whole = material("transversely_isotropic", {E_a, E_t, n_a, n_t, G_a}, {axis});
  const Material axes = material(
      "orthotropic", {E_a, E_t, E_t, G_a, E_t / (2 * (1 + n_t)), G_a, n_a, n_t, n_a * E_t / E_a}, {axis});
  EXPECT_NEAR(energy_density<3>(whole, F), energy_density<3>(axes, F), 1e-13);
  // A turn about the axis changes nothing.
  const Matrix<3> Q = Eigen::AngleAxisd(0.7, axis).toRotationMatrix();
  EXPECT_NEAR(energy_density<3>(whole, F * Q), energy_density<3>(whole, F), 1e-13);
}

/// At a state without change of volume, whose Green strain has all components.
TEST(FungOrthotropicAndGuccione, AreTheExponentialsOfTheirForms) {
  Matrix<3> F;
  F << 1.2, 0.3, 0.1, -0.1, 0.9, 0.2, 0.05, -0.15, 1.1;
  F /= std::cbrt(F.determinant());
  const Matrix<3> E = 0.5 * (F.transpose() * F - Matrix<3>::Identity());
  const double b_f = 8, b_t = 2, b_fs = 4, c = 0.9;
  const double Q = b_f * E(0, 0) * E(0, 0) +
                   b_t * (E(1, 1) * E(1, 1) + E(2, 2) * E(2, 2) + 2 * E(1, 2) * E(1, 2)) +
                   2 * b_fs * (E(0, 1) * E(0, 1) + E(0, 2) * E(0, 2));
  const Material heart = material("guccione", {c, b_f, b_t, b_fs, 100}, {Vector3::UnitX()});
  EXPECT_NEAR(energy_density<3>(heart, F), 0.5 * c * std::expm1(Q), 1e-13);

  const std::vector<double> moduli = {1.0, 2.0, 3.0, 0.4, 0.5, 0.6, 0.3, 0.2, 0.1};
  std::vector<double> all = moduli;
  all.insert(all.end(), {c, 100.0});
  const std::vector<Vector3> axes = {Vector3::UnitX(), Vector3::UnitY()};
  const double quadratic = energy_density<3>(material("orthotropic", moduli, axes), F);
  EXPECT_NEAR(energy_density<3>(material("fung_orthotropic", all, axes), F),
              0.5 * c * std::expm1(2 * quadratic / c), 1e-13);
}

}  // namespace
}  // namespace resilin
