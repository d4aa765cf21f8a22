// A law in 2D is the same law in 3D at diag(F_2, 1), also where a cell is inverted and it matters which of
// the three stretches is the negative one.
#include <gtest/gtest.h>

#include <cmath>

#include "resilin/material/derive.hpp"
#include "sample_states.hpp"

namespace resilin {
namespace {

using testing::random_rotation;
using testing::sample_hooke;
using testing::sample_material;

Matrix<3> embedded(const Matrix<2>& F) {
  Matrix<3> full = Matrix<3>::Identity();
  full.topLeftCorner<2, 2>() = F;
  return full;
}

/// U diag(s, t) V^T with det F > 0, or < 0.
Matrix<2> state(double s, double t, bool is_inverted, std::mt19937& random) {
  const Matrix<2> U = random_rotation<2>(random), V = random_rotation<2>(random);
  return U * Vector<2>(s, is_inverted ? -t : t).asDiagonal() * V.transpose();
}

struct Sample {
  Matrix<2> F;
  double s, t;  ///< its singular values
};

/// Random singular values in [0.1, 2.5], of which an inverted state has two smallest ones (the 1 across the
/// plane included) that are apart, so that its rotation is unique.
std::vector<Sample> random_states(bool is_inverted, int count) {
  std::mt19937 random(is_inverted ? 5 : 6);
  std::uniform_real_distribution<double> length(0.1, 2.5);
  std::vector<Sample> samples;
  while (static_cast<int>(samples.size()) < count) {
    const double s = length(random), t = length(random);
    std::array<double, 3> sorted = {s, t, 1};
    std::ranges::sort(sorted);
    if (is_inverted && sorted[1] - sorted[0] < 0.05) continue;
    samples.push_back({state(s, t, is_inverted, random), s, t});
  }
  return samples;
}

/// The two values from 3D, when each is finite; else neither is.
template <class Derived>
void expect_equal(const Eigen::MatrixBase<Derived>& plane, const Eigen::MatrixBase<Derived>& space,
                  double scale, const char* what, const Sample& sample) {
  ASSERT_EQ(plane.allFinite(), space.allFinite()) << what << " at\n" << sample.F;
  if (!space.allFinite()) return;
  EXPECT_LT((plane - space).norm(), 1e-10 * scale)
      << what << " at stretches " << sample.s << ", " << sample.t;
}

void compare_with_space(const Material& material, const Sample& sample) {
  const Matrix<3> full = embedded(sample.F);
  const double in_plane = energy_density<2>(material, sample.F), in_space = energy_density<3>(material, full);
  if (std::isfinite(in_space)) {
    EXPECT_NEAR(in_plane, in_space, 1e-10 * (std::abs(in_space) + sample_hooke().mu));
  } else {
    EXPECT_FALSE(std::isfinite(in_plane));
  }

  const Matrix<3> P = first_piola_kirchhoff_stress<3>(material, full);
  expect_equal(first_piola_kirchhoff_stress<2>(material, sample.F), Matrix<2>(P.topLeftCorner<2, 2>()),
               P.norm() + sample_hooke().mu, "stress", sample);

  const TangentMatrix<3> A = stress_tangent<3>(material, full);
  TangentMatrix<2> of_plane;
  constexpr std::array<int, 4> place = {0, 1, 3, 4};  // columns of 2x2 in those of 3x3
  for (int i = 0; i < 4; ++i)
    for (int k = 0; k < 4; ++k)
      of_plane(i, k) = A(place[static_cast<std::size_t>(i)], place[static_cast<std::size_t>(k)]);
  // Twists are divided by sums of stretches, which the samples keep above 0.05.
  expect_equal(stress_tangent<2>(material, sample.F), of_plane, A.norm() + sample_hooke().mu, "tangent",
               sample);
}

struct PlaneStrain : ::testing::TestWithParam<const LawInfo*> {};
INSTANTIATE_TEST_SUITE_P(EveryLaw, PlaneStrain, ::testing::ValuesIn(laws()),
                         [](const auto& entry) { return std::string(entry.param->name); });

TEST_P(PlaneStrain, IsTheSameStateInSpace) {
  const Material material = sample_material(*GetParam());
  for (const bool is_inverted : {false, true})
    for (const Sample& sample : random_states(is_inverted, 200)) compare_with_space(material, sample);
}

TEST_P(PlaneStrain, HasTheSlopesOfItsEnergyWhereItIsInverted) {
  const LawInfo& law = *GetParam();
  if (law.needs_positive_J) return;
  const Material material = sample_material(law);
  for (const Sample& sample : random_states(true, 40)) {
    const Matrix<2> P = first_piola_kirchhoff_stress<2>(material, sample.F);
    const TangentMatrix<2> A = stress_tangent<2>(material, sample.F);
    const double step = 1e-5, scale = P.norm() + A.norm() + sample_hooke().mu;
    for (int i = 0; i < 4; ++i) {
      Matrix<2> plus = sample.F, minus = sample.F;
      plus(i) += step;
      minus(i) -= step;
      const double slope =
          (energy_density<2>(material, plus) - energy_density<2>(material, minus)) / (2 * step);
      EXPECT_NEAR(slope, P(i), 1e-6 * scale) << sample.s << ", " << sample.t;
      const Matrix<2> slopes = (first_piola_kirchhoff_stress<2>(material, plus) -
                                first_piola_kirchhoff_stress<2>(material, minus)) /
                               (2 * step);
      EXPECT_LT((A.col(i) - slopes.reshaped()).norm(), 1e-6 * scale) << sample.s << ", " << sample.t;
    }
  }
}

/// The negative stretch goes from a direction of the plane to the one across it: the energy is continuous
/// there, and bends downwards, for it is the lesser one of the two.
TEST_P(PlaneStrain, HasAContinuousEnergyWhereTheNegativeStretchChanges) {
  const LawInfo& law = *GetParam();
  if (law.needs_positive_J) return;
  const Material material = sample_material(law);
  std::mt19937 random(8);
  const Matrix<2> U = random_rotation<2>(random), V = random_rotation<2>(random);
  const auto energy = [&](double s, double t) {
    return energy_density<2>(material, U * Vector<2>(s, -t).asDiagonal() * V.transpose());
  };
  for (const double s : {1.1, 1.5, 2.5}) {
    const double step = 1e-7;
    const double before = energy(s, 1 - step), after = energy(s, 1 + step);
    const double scale = std::abs(before) + sample_hooke().mu;
    EXPECT_NEAR(before, after, 1e2 * step * scale) << s;
    if (law.kind != LawKind::stretches) continue;
    const double slope_before = (before - energy(s, 1 - 2 * step)) / step;
    const double slope_after = (energy(s, 1 + 2 * step) - after) / step;
    EXPECT_LT(slope_after, slope_before) << s;
  }
}

/// Psi = mu |F - R|^2 with the nearest rotation of space, which in the signed stretches is one of four.
TEST(Arap, TakesTheNearestRotationOfSpaceInThePlane) {
  const LawInfo* law = find_law("arap");
  const Material material = sample_material(*law);
  const double mu = material.constants[0];
  for (const Sample& sample : random_states(true, 100)) {
    double nearest = std::numeric_limits<double>::infinity();
    for (const std::array<int, 3> sign : {std::array{1, 1, -1}, {1, -1, 1}, {-1, 1, 1}, {-1, -1, -1}})
      nearest = std::min(nearest, std::pow(sign[0] * sample.s - 1, 2) + std::pow(sign[1] * sample.t - 1, 2) +
                                      std::pow(sign[2] - 1, 2));
    EXPECT_NEAR(energy_density<2>(material, sample.F), mu * nearest, 1e-12 * mu * nearest)
        << sample.s << ", " << sample.t;
  }
}

/// Where s_2 = 1 across the plane is as short as the shorter one in it, neither rotation is nearer.
TEST(LawsOfStretches, GiveNoNumberWhereTwoRotationsAreAsNear) {
  for (const LawInfo* law : laws()) {
    if (law->kind != LawKind::stretches || law->needs_positive_J) continue;
    const Matrix<2> F = Vector<2>(1.5, -1).asDiagonal();
    EXPECT_TRUE(std::isnan(energy_density<2>(sample_material(*law), F))) << law->name;
    EXPECT_TRUE(std::isnan(energy_density<3>(sample_material(*law), embedded(F)))) << law->name;
  }
}

}  // namespace
}  // namespace resilin
