#include "resilin/core/relaxation.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

namespace resilin {
namespace {

/// x -> a + ratio x, which by itself settles for |ratio| < 1 alone, is solved by the third share.
TEST(Relaxation, SolvesALinearMapAtOnce) {
  for (const double ratio : {-3.0, -1.0, -0.5, 0.0, 0.4}) {
    Relaxation relaxation;
    double x = 5;
    for (int round = 0; round < 3; ++round) {
      const std::array change = {1 + ratio * x - x};
      x += relaxation.next_share(change) * change[0];
    }
    EXPECT_NEAR(x, 1 / (1 - ratio), 1e-14) << ratio;
  }
}

/// Several numbers that turn around each other, as forces across and along a surface do.
TEST(Relaxation, SettlesWhatTurns) {
  for (const double ratio : {0.5, 1.0, 1.5}) {
    Relaxation relaxation;
    std::array<double, 2> x = {1, 0.5}, change{};
    for (int round = 0; round < 60; ++round) {
      change = {-ratio * x[1] - x[0], ratio * x[0] - x[1]};
      const double share = relaxation.next_share(change);
      for (std::size_t i = 0; i < 2; ++i) x[i] += share * change[i];
    }
    EXPECT_LT(std::hypot(x[0], x[1]), 1e-4) << ratio;
  }
}

TEST(Relaxation, TakesMoreThanAllWhereItLeadsOn) {
  Relaxation relaxation;
  double x = 0;
  int rounds = 0;
  for (; std::abs(x - 100) > 1e-3 && rounds < 1000; ++rounds) {
    const std::array change = {std::tanh(100 - x)};
    x += relaxation.next_share(change) * change[0];
  }
  EXPECT_LT(rounds, 60);
}

TEST(Relaxation, OfNothingIsAll) {
  Relaxation relaxation;
  for (int round = 0; round < 3; ++round) EXPECT_EQ(relaxation.next_share(std::array{0.0, 0.0}), 1);
}

}  // namespace
}  // namespace resilin
