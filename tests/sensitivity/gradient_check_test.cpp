#include "resilin/sensitivity/gradient_check.hpp"

#include <cmath>
#include <functional>
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
  EXPECT_EQ(same.verdict(), Verdict::open);
  // Higher orders remain at large steps, noise at the smallest.
  EXPECT_EQ(check_of(1e-9, {1e-4, 1e-6, 1e-8}, 1e-10).verdict(), Verdict::no_digits);
}

/// The check of a function of one number at zero, in place of a scene.
GradientCheck check_of(double slope, const std::function<double(double)>& f) {
  GradientCheck check{.parameter = "p", .slope = slope, .steps = {1e-2, 1e-3, 1e-4}};
  std::vector<SampledDifference> samples;
  for (const double h : {1e-2, 1e-3, 1e-4, 3e-3, 3e-4, 3e-5, 1e-5, 3e-6, 1e-6})
    samples.push_back({.step = h, .before = (f(0) - f(-h)) / h, .after = (f(h) - f(0)) / h});
  for (std::size_t k = 0; k < 3; ++k) check.differences[k] = 0.5 * (samples[k].before + samples[k].after);
  check.limits = limits_of(samples);
  return check;
}

/// As runs have it: the same for the same number, and like no other.
double noise_of(double t) { return std::sin(1e13 * t + 1e9 * t * t); }

TEST(GradientCheck, IsWithinWhatDifferencesLeadTo) {
  // It bends on the scale of a thousandth of the number, and runs are noisy.
  const auto bent = [](double t) { return std::sin(1000 * t) + 1e-5 * noise_of(t); };
  EXPECT_EQ(check_of(1000, bent).verdict(), Verdict::is_within);
  EXPECT_EQ(check_of(1100, bent).verdict(), Verdict::differs);
  EXPECT_EQ(check_of(-1000, bent).verdict(), Verdict::differs);
  EXPECT_NEAR(check_of(0, bent).limits.central.value, 1000, 20);
}

TEST(GradientCheck, SeesAKinkByBothSides) {
  const auto kinked = [](double t) { return (t > 0 ? 3 : 1) * t + 4 * t * t; };
  for (const double slope : {1.0, 2.0, 3.0}) EXPECT_EQ(check_of(slope, kinked).verdict(), Verdict::kink);
  for (const double slope : {-1.1, 5.1}) EXPECT_EQ(check_of(slope, kinked).verdict(), Verdict::differs);
  const DifferenceLimits limits = check_of(2, kinked).limits;
  EXPECT_NEAR(limits.before.value, 1, 1e-9);
  EXPECT_NEAR(limits.after.value, 3, 1e-9);
  // One beside the place, farther than the shortest steps.
  const auto near = [](double t) { return t + std::max(0.0, t - 2e-5); };
  EXPECT_NE(check_of(1, near).verdict(), Verdict::differs);
}

TEST(GradientCheck, IsOpenWhereDifferencesLeadNowhere) {
  // Another solution at each step, and a jump.
  EXPECT_EQ(check_of(1e-9, [](double t) { return 0.1 * noise_of(t); }).verdict(), Verdict::open);
  EXPECT_EQ(check_of(1, [](double t) { return t > 0 ? 1.0 + t : t; }).verdict(), Verdict::open);
  EXPECT_EQ(check_of(1, [](double) { return nan; }).verdict(), Verdict::open);
}

TEST(GradientCheck, DiffersWhereDifferencesHaveDigits) {
  const auto line = [](double t) { return 2 * t + t * t + t * t * t; };
  EXPECT_EQ(check_of(2.1, line).verdict(), Verdict::differs);
  EXPECT_EQ(check_of(0, line).verdict(), Verdict::differs);
  EXPECT_EQ(check_of(2, line).verdict(), Verdict::is_within);  // its digits were not counted
  // Differences that are noise, but less of it than the derivative would be, confirm nothing.
  EXPECT_EQ(check_of(1e-9, {2e-13, -1e-12, 3e-11}, 1e-12).verdict(), Verdict::open);
  EXPECT_EQ(check_of(-1e-11, {2e-13, -1e-12, 3e-11}, 1e-12).verdict(), Verdict::open);
}

TEST(GradientCheck, DiffersWhereItIsNoNumber) {
  for (const double none : {nan, infinite, -infinite}) {
    EXPECT_EQ(check_of(none, {2e-13, -1e-12, 3e-11}, 1e-12).verdict(), Verdict::differs);
    for (std::size_t k = 0; k < 3; ++k) {
      GradientCheck check = check_of(1e-18, {2e-13, -1e-12, 3e-11}, 1e-12);
      check.differences[k] = none;
      EXPECT_EQ(check.verdict(), Verdict::open);
    }
    EXPECT_EQ(check_of(1e-18, {none, none, none}, 1e-12).verdict(), Verdict::open);
    GradientCheck agreed = check_of(none, {1, 1, 1}, 1e-12);
    agreed.digits = 16;
    EXPECT_EQ(agreed.verdict(), Verdict::differs);
  }
  EXPECT_EQ(check_of(1e-18, {2e-13, -1e-12, 3e-11}, nan).verdict(), Verdict::open);
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
    EXPECT_EQ(wrong.verdict(), Verdict::open);
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

/// A wall that moves does work, so that a run whose energy has risen a little is slowed down where it would
/// not be beside a wall that stands: such runs are no differences of the one that is differentiated.
TEST(GradientChecks, CompareWithNoRunThatTakesOtherSteps) {
  Description scene = small_bar(3, true);
  scene.integrator = "newmark";
  scene.gravity = {0, 0, -4.905};
  BodyDescription& body = scene.bodies[0];
  body.mesh = make_box({0.8, 0.25, 0.25}, {5, 2, 2});
  body.mass = MassKind::consistent;
  body.material.constants = {{"youngs_modulus", 3e5}, {"poissons_ratio", 0.2}};
  body.velocity = {0, -0.84, 0.71};
  const std::string velocity = "fix.wall.velocity";
  scene.fixes[0].velocity = {1e-6, 0, 0};
  EXPECT_THROW(Derivatives::run(scene, {velocity}), InputError);  // it is slowed down
  scene.fixes[0].velocity = Vector3::Zero();
  const GradientCheck check = check_gradients(scene, {velocity}).front();
  EXPECT_TRUE(std::isnan(check.differences[2]));
  EXPECT_EQ(check.verdict(), Verdict::open);
}

}  // namespace
}  // namespace resilin::testing
