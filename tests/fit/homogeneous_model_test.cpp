#include "resilin/fit/homogeneous_model.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "resilin/core/error.hpp"
#include "resilin/core/spelling.hpp"
#include "resilin/fit/law_choice.hpp"
#include "resilin/material/curve.hpp"

namespace resilin {
namespace {

constexpr TestMode isochoric_modes[] = {TestMode::uniaxial, TestMode::equibiaxial, TestMode::planar,
                                        TestMode::simple_shear};
constexpr TestMode all_modes[] = {TestMode::uniaxial,     TestMode::equibiaxial, TestMode::planar,
                                  TestMode::simple_shear, TestMode::volumetric,  TestMode::confined};

std::vector<LoadedState> some_states(TestMode mode) {
  if (mode == TestMode::simple_shear) return {{mode, -0.4}, {mode, 0.1}, {mode, 0.9}};
  if (!keeps_volume(mode)) return {{mode, 0.93}, {mode, 0.99}, {mode, 1.05}};
  return {{mode, 0.7}, {mode, 0.95}, {mode, 1.1}, {mode, 1.7}, {mode, 2.6}};
}

/// Constants of unlike size, so that no slope vanishes by symmetry.
std::vector<double> sample_constants(const LawInfo& law) {
  std::vector<double> constants = law.constants_from(
      hooke_from_young_poisson(1.3, std::isnan(law.only_poissons_ratio) ? 0.4 : law.only_poissons_ratio));
  return constants;
}

/// Slopes by central differences of the values; smooth functions of size 1, so that a step of 1e-6 leaves
/// 1e-9. A zero before high powers of large invariants needs a smaller step.
void expect_slopes(const LawInfo& law, bool is_compressible, TestMode mode) {
  // Laws with a volume term of the trace press their sides to nothing in large stretches.
  const bool is_for_small_strains =
      law.is_quadratic || law.name == "saint_venant_kirchhoff" || law.name == "corotated_linear";
  const HomogeneousModel model(law, is_compressible,
                               is_for_small_strains && mode != TestMode::simple_shear
                                   ? std::vector<LoadedState>{{mode, 0.93}, {mode, 1.05}}
                                   : some_states(mode));
  const std::vector<double> constants = sample_constants(law);
  std::vector<int> places(constants.size());
  std::iota(places.begin(), places.end(), 0);
  VectorX values;
  DenseMatrix slopes;
  ASSERT_TRUE(model.evaluate(constants, places, &values, &slopes)) << law.name << spelling(mode);
  for (std::size_t p = 0; p < constants.size(); ++p) {
    const double steepest = slopes.col(static_cast<Eigen::Index>(p)).cwiseAbs().maxCoeff();
    const double h = 1e-6 * std::max(constants[p] == 0 ? 0.1 / std::sqrt(std::max(1.0, steepest)) : 0.1,
                                     std::abs(constants[p]));
    std::vector<double> more = constants, less = constants;
    more[p] += h;
    less[p] -= h;
    VectorX above, below;
    ASSERT_TRUE(model.evaluate(more, {}, &above, nullptr));
    ASSERT_TRUE(model.evaluate(less, {}, &below, nullptr));
    const VectorX difference = (above - below) / (2 * h);
    const double scale = std::max(1.0, difference.cwiseAbs().maxCoeff());
    EXPECT_LT((slopes.col(static_cast<Eigen::Index>(p)) - difference).cwiseAbs().maxCoeff(), 3e-8 * scale)
        << law.name << " " << spelling(mode) << " " << law.constants[p].name;
  }
}

TEST(HomogeneousModel, HasTheSlopesOfEveryLawInEveryModeOfTheIncompressibleLimit) {
  int count = 0;
  for (const LawInfo* law : laws()) {
    try {
      choose_law(std::string(law->name), false, "laws");
    } catch (const InputError&) {
      continue;
    }
    for (const TestMode mode : isochoric_modes) expect_slopes(*law, false, mode);
    ++count;
  }
  EXPECT_GE(count, 11);
}

TEST(HomogeneousModel, HasTheSlopesOfEveryCompressibleLawInEveryMode) {
  for (const LawInfo* law : laws())
    if (law->max_fibres == 0)
      for (const TestMode mode : all_modes) expect_slopes(*law, true, mode);
}

// Closed forms of W = mu/2 (I1 - 3): methods of any textbook.
TEST(HomogeneousModel, IsTheTextbookNeoHookeanSolid) {
  for (const char* name : {"neo_hookean", "neo_hookean_isochoric", "neo_hookean_simo", "stable_neo_hookean"})
    for (const double l : {0.5, 0.999999, 1.3, 4.0}) {
      const std::vector<double> constants = {2.0, 0.0};
      const HomogeneousModel model(*find_law(name), false,
                                   {{TestMode::uniaxial, l},
                                    {TestMode::equibiaxial, l},
                                    {TestMode::planar, l},
                                    {TestMode::simple_shear, l - 1}});
      const VectorX P = model.stresses(constants);
      const double scale = 1e-13 * 2 * (l + std::pow(l, -5));
      EXPECT_NEAR(P[0], 2 * (l - std::pow(l, -2)), scale) << name;
      EXPECT_NEAR(P[1], 2 * (l - std::pow(l, -5)), scale) << name;
      EXPECT_NEAR(P[2], 2 * (l - std::pow(l, -3)), scale) << name;
      EXPECT_NEAR(P[3], 2 * (l - 1), scale) << name;
    }
}

// W_1 and W_2 of Mooney and Rivlin in P = 2 (l - l^-2)(W1 + W2/l) and its kin.
TEST(HomogeneousModel, IsTheTextbookMooneyRivlinSolid) {
  const double c10 = 0.7, c01 = 0.2, l = 1.8;
  const std::vector<double> constants = {c10, c01, 0};
  const HomogeneousModel model(*find_law("mooney_rivlin"), false,
                               {{TestMode::uniaxial, l}, {TestMode::equibiaxial, l}, {TestMode::planar, l}});
  const VectorX P = model.stresses(constants);
  EXPECT_NEAR(P[0], 2 * (l - std::pow(l, -2)) * (c10 + c01 / l), 1e-13);
  EXPECT_NEAR(P[1], 2 * (l - std::pow(l, -5)) * (c10 + l * l * c01), 1e-13);
  EXPECT_NEAR(P[2], 2 * (l - std::pow(l, -3)) * (c10 + c01), 1e-13);
}

// Ogden's constants are those of sum mu/alpha (...), so that P = sum mu (l^(a-1) - l^(-a/2-1)).
TEST(HomogeneousModel, HasOgdensConvention) {
  const double l = 2.2;
  const std::vector<double> constants = {0.3, 1.7, 0.01, 5.0, -0.05, -2.1, 0};
  const double P =
      HomogeneousModel(*find_law("ogden"), false, {{TestMode::uniaxial, l}}).stresses(constants)[0];
  double expected = 0;
  for (const auto& [mu, a] : {std::pair(0.3, 1.7), std::pair(0.01, 5.0), std::pair(-0.05, -2.1)})
    expected += mu * (std::pow(l, a - 1) - std::pow(l, -a / 2 - 1));
  EXPECT_NEAR(P, expected, 1e-13);
}

// Two implementations of the same free faces: curves follow a branch from rest, this solves each state.
TEST(HomogeneousModel, AgreesWithTheCurvesOfTheMaterial) {
  for (const char* name : {"neo_hookean", "yeoh", "ogden", "gent", "corotated"})
    for (const auto& [mode, load_case] :
         {std::pair(TestMode::uniaxial, LoadCase::uniaxial),
          std::pair(TestMode::equibiaxial, LoadCase::equibiaxial),
          std::pair(TestMode::planar, LoadCase::planar), std::pair(TestMode::simple_shear, LoadCase::shear),
          std::pair(TestMode::volumetric, LoadCase::volumetric)}) {
      const LawInfo& law = *find_law(name);
      const Material material{&law, law.constants_from(hooke_from_young_poisson(1e6, 0.45)), {}};
      const std::vector<double> loads = {1.02, 1.2, 1.5};
      std::vector<LoadedState> states;
      for (const double load : loads) states.push_back({mode, load});
      const VectorX P = HomogeneousModel(law, true, states).stresses(material.constants);
      const StretchCurve curve = stretch_curve(material, load_case, loads);
      for (std::size_t i = 0; i < loads.size(); ++i)
        EXPECT_NEAR(P[static_cast<Eigen::Index>(i)], curve.nominal_stress[i],
                    1e-8 * std::abs(curve.nominal_stress[i]))
            << name << " " << spelling(mode);
    }
}

// As Poisson's ratio goes to 1/2 the compressible law becomes the incompressible one, linearly.
TEST(HomogeneousModel, HasTheIncompressibleLimit) {
  const LawInfo& law = *find_law("neo_hookean_isochoric");
  const std::vector<LoadedState> states = {
      {TestMode::uniaxial, 2.0}, {TestMode::equibiaxial, 1.6}, {TestMode::planar, 0.6}};
  const VectorX limit = HomogeneousModel(law, false, states).stresses(std::vector<double>{1, 0});
  const VectorX near = HomogeneousModel(law, true, states).stresses(std::vector<double>{1, 1e6});
  EXPECT_LT((near - limit).cwiseAbs().maxCoeff(), 1e-5);
  EXPECT_GT((near - limit).cwiseAbs().maxCoeff(), 1e-8);
}

TEST(HomogeneousModel, HasNoStressOutsideTheDomain) {
  const HomogeneousModel model(*find_law("gent"), false,
                               {{TestMode::uniaxial, 1.5}, {TestMode::uniaxial, 9.0}});
  const std::vector<double> constants = {1, 20, 0};
  VectorX values;
  EXPECT_FALSE(model.evaluate(constants, {}, &values, nullptr));
  const VectorX each = model.stresses(constants);
  EXPECT_TRUE(std::isfinite(each[0]));
  EXPECT_TRUE(std::isnan(each[1]));
}

TEST(LawChoice, KnowsInWhichConstantsAnEnergyIsLinear) {
  const auto linear = [](const char* name) { return choose_law(name, false, "laws").linear; };
  const auto nonlinear = [](const char* name) { return choose_law(name, false, "laws").nonlinear; };
  EXPECT_EQ(linear("yeoh"), (std::vector<int>{0, 1, 2}));
  EXPECT_TRUE(nonlinear("yeoh").empty());
  EXPECT_EQ(linear("gent"), (std::vector<int>{0}));
  EXPECT_EQ(nonlinear("gent"), (std::vector<int>{1}));
  EXPECT_EQ(linear("ogden2"), (std::vector<int>{0, 2}));
  EXPECT_EQ(nonlinear("ogden2"), (std::vector<int>{1, 3}));
  EXPECT_EQ(choose_law("arruda_boyce", false, "laws").volume_constant, 2);
  EXPECT_EQ(choose_law("neo_hookean", false, "laws").volume_constant, 1);
}

}  // namespace
}  // namespace resilin
