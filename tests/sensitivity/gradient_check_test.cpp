#include "resilin/sensitivity/gradient_check.hpp"

#include <limits>

#include "small_scenes.hpp"

namespace resilin::testing {
namespace {

using Verdict = GradientCheck::Verdict;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double infinite = std::numeric_limits<double>::infinity();

/// Without a digit in common, as `check_gradients` would hold them.
GradientCheck check_of(double slope, const std::array<double, 3>& differences, double noise) {
  return {.parameter = "p",
          .slope = slope,
          .steps = {1e-2, 1e-3, 1e-4},
          .differences = differences,
          .noise = noise};
}

TEST(GradientCheck, HasNoDigitsWhereDifferencesAreNoise) {
  EXPECT_EQ(check_of(1e-18, {2e-13, -1e-12, 3e-11}, 1e-12).verdict(), Verdict::no_digits);
  // Runs that are the same bit by bit.
  GradientCheck same = check_of(1e-25, {0, 0, 0}, 1e-12);
  same.rounding = 1e-16;
  EXPECT_EQ(same.verdict(), Verdict::no_digits);
  same.slope = 1e-9;
  EXPECT_EQ(same.verdict(), Verdict::differs);
  // What is left of higher orders at large steps, noise at the smallest.
  EXPECT_EQ(check_of(1e-9, {1e-4, 1e-6, 1e-8}, 1e-10).verdict(), Verdict::no_digits);
}

TEST(GradientCheck, DiffersWhereDifferencesHaveDigits) {
  EXPECT_EQ(check_of(1e-9, {1e-4, 1.2e-9, 1.21e-9}, 1).verdict(), Verdict::differs);
  // Noise, but less of it than the derivative would be.
  EXPECT_EQ(check_of(1e-9, {2e-13, -1e-12, 3e-11}, 1e-12).verdict(), Verdict::differs);
  EXPECT_EQ(check_of(-1e-11, {2e-13, -1e-12, 3e-11}, 1e-12).verdict(), Verdict::differs);
  // Another solution at each step: runs differ by 0.1 whatever the step.
  EXPECT_EQ(check_of(1e-9, {10, 100, 1000}, 1e-10).verdict(), Verdict::differs);
}

TEST(GradientCheck, DiffersWhereANumberIsNone) {
  for (const double none : {nan, infinite, -infinite}) {
    EXPECT_EQ(check_of(none, {2e-13, -1e-12, 3e-11}, 1e-12).verdict(), Verdict::differs);
    for (std::size_t k = 0; k < 3; ++k) {
      GradientCheck check = check_of(1e-18, {2e-13, -1e-12, 3e-11}, 1e-12);
      check.differences[k] = none;
      EXPECT_EQ(check.verdict(), Verdict::differs);
    }
    EXPECT_EQ(check_of(1e-18, {none, none, none}, 1e-12).verdict(), Verdict::differs);
    GradientCheck agreed = check_of(none, {1, 1, 1}, 1e-12);
    agreed.digits = 16;
    EXPECT_EQ(agreed.verdict(), Verdict::differs);
  }
  EXPECT_EQ(check_of(1e-18, {2e-13, -1e-12, 3e-11}, nan).verdict(), Verdict::differs);
}

/// A bar that is pulled, of which the weight is next to nothing.
TEST(GradientChecks, OfWhatHardlyMattersHaveNoDigits) {
  Description scene = small_bar(2, false);
  LoadDescription pull;
  pull.name = "pull";
  pull.kind = "traction";
  pull.where.kind = Where::Kind::plane;
  pull.where.at = 1;
  pull.value = {5e3, 1e3, 0};
  scene.loads.push_back(pull);
  for (const double gravity : {1e-12, 1e-16, 1e-100}) {
    SCOPED_TRACE(gravity);
    scene.gravity = {0, -gravity, 0};
    const std::vector<GradientCheck> checks =
        check_gradients(scene, {"body.body.density", "load.pull.value", "body.body.material.youngs_modulus"});
    EXPECT_EQ(checks[0].verdict(), Verdict::no_digits);
    EXPECT_NE(checks[0].slope, 0);
    EXPECT_EQ(checks[1].verdict(), Verdict::agrees);
    EXPECT_EQ(checks[2].verdict(), Verdict::agrees);
    // The same differences beside derivatives that are wrong by so much that they would be seen.
    GradientCheck wrong = checks[0];
    wrong.slope += 1e-6 * checks[2].slope * 1e5 / 1000;
    EXPECT_EQ(wrong.verdict(), Verdict::differs);
    wrong = checks[2];
    wrong.slope *= 1.01;
    wrong.digits = 2;
    EXPECT_EQ(wrong.verdict(), Verdict::differs);
  }
}

/// Its differences reach numbers with which "auto" would choose another element.
TEST(GradientChecks, KeepTheElementsOfTheScene) {
  Description scene = small_bar(2, false);
  scene.bodies[0].element = "auto";
  scene.bodies[0].material.constants["poissons_ratio"] = 0.4499;
  scene.gravity = {0, -9.81, 0};
  const std::vector<GradientCheck> checks = check_gradients(scene, {"body.body.material.poissons_ratio"});
  EXPECT_EQ(checks[0].verdict(), Verdict::agrees);
}

}  // namespace
}  // namespace resilin::testing
