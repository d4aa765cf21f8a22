// Laws whose energy ends at a stretch: runs that come close to it, and what is said where they end.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "small_scenes.hpp"

namespace resilin::testing {
namespace {

using ::testing::HasSubstr;

/// A bar, held at both ends, that is drawn out to this many times its length.
Description drawn_bar(const std::string& element, double limit, double poissons_ratio, double stretch) {
  Description scene = small_bar(3, false);
  scene.gravity.setZero();
  BodyDescription& body = scene.bodies[0];
  body.element = element;
  body.mesh = make_box({1, 0.25, 0.25}, {4, 1, 1});
  body.material.law = "gent";
  body.material.constants = {{"youngs_modulus", 1e5}, {"poissons_ratio", poissons_ratio}, {"limit", limit}};
  FixDescription end = scene.fixes[0];
  end.name = "end";
  end.where.at = 1;
  end.displacement = {stretch - 1, 0, 0};
  scene.fixes.push_back(end);
  return scene;
}

/// The stretch of an incompressible bar at which I_C - 3 is this.
double stretch_at(double invariant) {
  double s = std::sqrt(invariant + 3);
  for (int i = 0; i < 50; ++i) s -= (s * s + 2 / s - 3 - invariant) / (2 * s - 2 / (s * s));
  return s;
}

struct LimitedLaw : ::testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Cases, LimitedLaw, ::testing::Range(0, 40));

TEST_P(LimitedLaw, IsFollowedUpToItsLimit) {
  std::mt19937 generator(static_cast<unsigned>(GetParam()));
  std::uniform_real_distribution<double> exponent(-1, 2), share(0.3, 0.95), ratio(0.3, 0.495);
  const double limit = std::pow(10, exponent(generator)), nu = ratio(generator);
  const double stretch = stretch_at(share(generator) * limit);
  const std::string element = GetParam() % 2 == 0 ? "P1" : "P2";
  SCOPED_TRACE("limit " + std::to_string(limit) + ", stretch " + std::to_string(stretch) + ", nu " +
               std::to_string(nu) + ", " + element);
  Simulation simulation(drawn_bar(element, limit, nu, stretch));
  while (!simulation.is_finished()) {
    const StepReport report = simulation.step();
    ASSERT_EQ(report.status, StepReport::Status::converged) << report.reason;
  }
}

TEST(LimitedLaw, IsNamedWithItsLimitWhereARunEnds) {
  Description scene = drawn_bar("P1", 2, 0.499, 1);
  scene.fixes.pop_back();
  scene.newton.max_iterations = 5;
  LoadDescription pull;
  pull.name = "pull";
  pull.kind = "traction";
  pull.value = {1e9, 0, 0};
  pull.where.kind = Where::Kind::plane;
  pull.where.at = 1;
  scene.loads.push_back(pull);
  Simulation simulation(scene);
  StepReport report;
  do report = simulation.step();
  while (report.status == StepReport::Status::converged && !simulation.is_finished());
  EXPECT_EQ(report.status, StepReport::Status::not_converged);
  EXPECT_THAT(report.reason, HasSubstr("gent ends where J^(-2/3) I_C - 3 reaches J_m: reduce the load"));
}

}  // namespace
}  // namespace resilin::testing
