// Synthetic tests whose truth is known.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "resilin/fit/fit_report.hpp"
#include "resilin/fit/law_choice.hpp"

namespace resilin {
namespace {

/// Measurements of this law, with noise of so many parts of the largest stress, or of so
/// many Pa when it is above 1.
MaterialTest measured_test(const LawInfo& law, bool is_compressible, const std::vector<double>& constants,
                           TestMode mode, double from, double to, int count, double noise,
                           std::mt19937& random) {
  MaterialTest test;
  test.mode = mode;
  test.name = test.place = std::string(spellings(mode)[static_cast<std::size_t>(mode)]);
  test.has_unit = true;
  std::vector<LoadedState> states;
  for (int i = 0; i < count; ++i) {
    const double load = from + (to - from) * i / (count - 1);
    if (std::abs(load - rest_load(mode)) < 1e-6) continue;
    states.push_back({mode, load});
    test.load.push_back(load);
  }
  const VectorX stress = HomogeneousModel(law, is_compressible, states).stresses(constants);
  const double size = noise < 1 ? noise * stress.cwiseAbs().maxCoeff() : noise;
  std::normal_distribution<double> normal(0, size);
  for (const double value : stress) {
    test.stress.push_back(value + (noise > 0 ? normal(random) : 0));
    if (noise > 0) test.sigma.push_back(size);
  }
  return test;
}

const std::vector<double>& values_of(const LawFit& fit) { return fit.material.constants; }

struct Family {
  const char* name;
  std::vector<double> constants;  ///< [Pa] for a solid of about 0.4 MPa
};

const std::vector<Family>& families() {
  static const std::vector<Family> all = {
      {"neo_hookean", {4e5, 0}},
      {"mooney_rivlin", {1.6e5, 0.4e5, 0}},
      {"yeoh", {1.9e5, -1.4e3, 40, 0}},
      {"ogden1", {2.9e5, 2.3, 0, 2, 0, -2, 0}},
      {"ogden2", {5e5, 1.6, 2e3, 5.2, 0, -2, 0}},
      {"arruda_boyce", {2.7e5, 21, 0}},
      {"gent", {2.7e5, 84, 0}},
  };
  return all;
}

// Without noise the truth comes back, whatever the scale of the stresses.
TEST(FitOfSyntheticTests, RecoversTheTruthAtEveryScale) {
  std::mt19937 random(1);
  for (const Family& family : families())
    for (const double scale : {1e-4, 1.0, 1e5}) {
      const LawChoice choice = choose_law(family.name, false, "laws");
      std::vector<double> truth = family.constants;
      for (std::size_t p = 0; p < truth.size(); ++p)
        if (!choice.law->constants[p].unit.empty()) truth[p] *= scale;
      FitDescription description;
      for (const auto& [mode, end] :
           {std::pair(TestMode::uniaxial, 6.0), std::pair(TestMode::equibiaxial, 3.5),
            std::pair(TestMode::planar, 4.0), std::pair(TestMode::simple_shear, 2.0)})
        description.tests.push_back(measured_test(
            *choice.law, false, truth, mode, mode == TestMode::simple_shear ? 0 : 0.6, end, 23, 0, random));
      description.laws = {family.name};
      const LawFit fit = fit_materials(description).laws.front();
      for (const int p : choice.fitted()) {
        const auto k = static_cast<std::size_t>(p);
        EXPECT_NEAR(values_of(fit)[k], truth[k], 1e-6 * std::abs(truth[k]))
            << family.name << " " << scale << " " << p;
      }
      for (const TestQuality& quality : fit.tests) EXPECT_GT(quality.r_squared, 1 - 1e-12);
    }
}

// Random truths, noise, missing points: the sum of squares is never above that of the truth itself.
TEST(FitOfSyntheticTests, IsNeverWorseThanTheTruth) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> factor(0.5, 2);
  for (const Family& family : families())
    for (int trial = 0; trial < 6; ++trial) {
      const LawChoice choice = choose_law(family.name, false, "laws");
      std::vector<double> truth = family.constants;
      for (const int p : choice.fitted())
        truth[static_cast<std::size_t>(p)] *= choice.law->constants[static_cast<std::size_t>(p)].unit.empty()
                                                  ? 1 + 0.1 * (factor(random) - 1)
                                                  : factor(random);
      FitDescription description;
      for (const auto& [mode, end] :
           {std::pair(TestMode::uniaxial, 5.0), std::pair(TestMode::equibiaxial, 3.0)}) {
        description.tests.push_back(
            measured_test(*choice.law, false, truth, mode, 0.7, end, 40, 0.01, random));
        MaterialTest& test = description.tests.back();
        for (std::size_t i = test.load.size(); i-- > 0;)
          if (factor(random) < 1.0) {  // a third is missing
            test.load.erase(test.load.begin() + static_cast<std::ptrdiff_t>(i));
            test.stress.erase(test.stress.begin() + static_cast<std::ptrdiff_t>(i));
            test.sigma.erase(test.sigma.begin() + static_cast<std::ptrdiff_t>(i));
          }
      }
      description.laws = {family.name};
      description.stability = StabilityRule::report;
      double sum = 0;
      for (const MaterialTest& test : description.tests) {
        std::vector<LoadedState> states;
        for (const double load : test.load) states.push_back({test.mode, load});
        const VectorX stress = HomogeneousModel(*choice.law, false, states).stresses(truth);
        for (std::size_t i = 0; i < test.load.size(); ++i)
          sum += std::pow(stress[static_cast<Eigen::Index>(i)] - test.stress[i], 2);
      }
      EXPECT_LE(fit_materials(description).laws.front().sum_of_squares, sum) << family.name;
    }
}

// Intervals of 95 % hold the truth in 90 to 99 of 100 noisy sets (binomial: 2.5 standard deviations around
// 95).
TEST(FitOfSyntheticTests, HasIntervalsThatHoldTheTruth) {
  for (const ResidualKind residual : {ResidualKind::absolute, ResidualKind::sigma})
    for (const char* name : {"mooney_rivlin", "gent"}) {
      const LawChoice choice = choose_law(name, false, "laws");
      const std::vector<double> truth = std::string(name) == "gent" ? std::vector<double>{2.7e5, 84, 0}
                                                                    : std::vector<double>{1.6e5, 0.4e5, 0};
      std::vector<int> covered(2, 0);
      for (unsigned seed = 0; seed < 100; ++seed) {
        std::mt19937 random(1000 + seed);
        FitDescription description;
        description.residual = residual;
        description.stability = StabilityRule::off;
        for (const auto& [mode, end] : {std::pair(TestMode::uniaxial, 6.0), std::pair(TestMode::planar, 4.0)})
          description.tests.push_back(measured_test(*choice.law, false, truth, mode, 1, end, 20,
                                                    residual == ResidualKind::sigma ? 0.01 : 2e4, random));
        description.laws = {name};
        const LawFit fit = fit_materials(description).laws.front();
        for (std::size_t p = 0; p < 2; ++p)
          covered[p] += std::abs(fit.constants[p].value - truth[p]) <= fit.constants[p].half_width_95 ? 1 : 0;
      }
      for (const int count : covered) {
        EXPECT_GE(count, 90) << name;
        EXPECT_LE(count, 99) << name;
      }
    }
}

// A compressible law from tests that change its volume, and from those that do not.
TEST(FitOfSyntheticTests, FindsTheBulkModulusFromTestsThatChangeTheVolume) {
  std::mt19937 random(3);
  const LawInfo& law = *find_law("neo_hookean");
  for (const double poissons_ratio : {0.3, 0.49}) {
    const std::vector<double> truth = law.constants_from(hooke_from_young_poisson(1e6, poissons_ratio));
    FitDescription description;
    for (const auto& [mode, from, to] :
         {std::tuple(TestMode::uniaxial, 0.7, 2.0), std::tuple(TestMode::confined, 0.8, 1.0),
          std::tuple(TestMode::volumetric, 0.97, 1.0)})
      description.tests.push_back(measured_test(law, true, truth, mode, from, to, 12, 0, random));
    description.laws = {"neo_hookean"};
    const FitReport report = fit_materials(description);
    EXPECT_TRUE(report.is_compressible);
    const LawFit& fit = report.laws.front();
    EXPECT_NEAR(fit.poissons_ratio, poissons_ratio, 1e-6);
    EXPECT_NEAR(fit.youngs_modulus, 1e6, 1);
    EXPECT_FALSE(fit.volume_is_assumed);
  }
}

// Bars alone say little about the volume, which the report tells; a bulk modulus beyond measure is one
// optimum.
TEST(FitOfSyntheticTests, TellsThatTheVolumeIsNotHeld) {
  std::mt19937 random(8);
  const LawInfo& law = *find_law("yeoh");
  FitDescription description;
  for (const auto& [mode, end] : {std::pair(TestMode::uniaxial, 4.0), std::pair(TestMode::equibiaxial, 2.5)})
    description.tests.push_back(
        measured_test(law, false, {1.9e5, -1.4e3, 40, 0}, mode, 1, end, 20, 5e3, random));
  description.volume = VolumeRule::compressible;
  description.laws = {"yeoh"};
  const LawFit fit = fit_materials(description).laws.front();
  EXPECT_GT(fit.poissons_ratio, 0.45);
  EXPECT_GT(fit.constants.back().half_width_95, fit.constants.back().value);
  for (const std::string& warning : fit.warnings)
    EXPECT_EQ(warning.find("other constants"), std::string::npos);
}

TEST(FitOfSyntheticTests, FitsEveryCompressibleLawToItself) {
  std::mt19937 random(4);
  for (const LawInfo* law : laws()) {
    if (law->max_fibres > 0 || law->name == "ogden") continue;
    const double poissons_ratio = std::isnan(law->only_poissons_ratio) ? 0.35 : law->only_poissons_ratio;
    const std::vector<double> truth = law->constants_from(hooke_from_young_poisson(1e6, poissons_ratio));
    FitDescription description;
    for (const auto& [mode, from, to] :
         {std::tuple(TestMode::uniaxial, 0.9, 1.8), std::tuple(TestMode::equibiaxial, 0.95, 1.6),
          std::tuple(TestMode::confined, 0.85, 1.2)})
      description.tests.push_back(measured_test(*law, true, truth, mode, from, to, 15, 0, random));
    description.laws = {std::string(law->name)};
    description.volume = VolumeRule::compressible;
    description.stability = StabilityRule::off;
    const LawFit fit = fit_materials(description).laws.front();
    for (const TestQuality& quality : fit.tests) EXPECT_GT(quality.r_squared, 1 - 1e-9) << law->name;
    EXPECT_NEAR(fit.youngs_modulus, 1e6, 1e3) << law->name;
  }
}

// Laws that do not hold: residuals beyond the sigmas widen the intervals and are told.
TEST(FitOfSyntheticTests, TellsWhenALawDoesNotHoldToTheSigmas) {
  std::mt19937 random(5);
  const LawInfo& law = *find_law("gent");
  FitDescription description;
  description.residual = ResidualKind::sigma;
  description.tests.push_back(
      measured_test(law, false, {2.7e5, 60, 0}, TestMode::uniaxial, 1, 6.5, 30, 0.002, random));
  description.laws = {"gent", "neo_hookean"};
  const FitReport report = fit_materials(description);
  EXPECT_EQ(report.laws.front().name, "gent");
  EXPECT_TRUE(report.laws.front().warnings.empty());
  ASSERT_FALSE(report.laws.back().warnings.empty());
  EXPECT_NE(report.laws.back().warnings.front().find("times as large as the sigmas"), std::string::npos);
}

// The weight of a test pulls the fit towards it, and settings hold what they say.
TEST(FitOfSyntheticTests, FollowsWeightsAndSettings) {
  std::mt19937 random(6);
  const LawInfo& law = *find_law("yeoh");
  FitDescription description;
  for (const auto& [mode, end] : {std::pair(TestMode::uniaxial, 6.0), std::pair(TestMode::equibiaxial, 2.0)})
    description.tests.push_back(
        measured_test(law, false, {1.9e5, -1.4e3, 40, 0}, mode, 1, end, 20, 0, random));
  description.laws = {"neo_hookean"};
  const double before = fit_materials(description).laws.front().tests[1].root_mean_square;
  description.tests[1].weight = 1e4;
  EXPECT_LT(fit_materials(description).laws.front().tests[1].root_mean_square, 0.5 * before);
  description.laws = {"yeoh"};
  description.tests[1].weight = 1;
  description.constants = {{.name = "c30", .place = "c30", .value = 40.0}};
  const LawFit fixed = fit_materials(description).laws.front();
  EXPECT_EQ(fixed.num_fitted, 2);
  EXPECT_NEAR(fixed.constants[0].value, 1.9e5, 1);
  description.constants = {{.name = "yeoh.c20", .place = "c20", .lower = -1e3, .upper = 1e6}};
  const LawFit held = fit_materials(description).laws.front();
  EXPECT_TRUE(held.is_bounded);
  EXPECT_NEAR(held.constants[1].value, -1e3, 1e-2);
}

}  // namespace
}  // namespace resilin
