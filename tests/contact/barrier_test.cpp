#include "resilin/contact/barrier.hpp"

#include <gtest/gtest.h>

namespace resilin {
namespace {

constexpr double dhat = 3e-3;  // m
constexpr ClampedLogBarrier barrier{dhat};

TEST(ClampedLogBarrier, IsZeroBeyondItsActivationDistanceAndInfiniteInside) {
  EXPECT_EQ(barrier.value(dhat), 0);
  EXPECT_EQ(barrier.value(2 * dhat), 0);
  EXPECT_EQ(barrier.slope(1.5 * dhat), 0);
  EXPECT_EQ(barrier.curvature(1.5 * dhat), 0);
  EXPECT_EQ(barrier.value(0), std::numeric_limits<double>::infinity());
  EXPECT_EQ(barrier.value(-1), std::numeric_limits<double>::infinity());
  EXPECT_EQ(barrier.difference(dhat / 2, -dhat), std::numeric_limits<double>::infinity());
}

TEST(ClampedLogBarrier, RepelsEverMoreOnTheWayIn) {
  double last_slope = 0;
  for (double t = 0.99; t > 1e-12; t *= 0.7) {
    EXPECT_GT(barrier.value(t * dhat), 0);
    EXPECT_LT(barrier.slope(t * dhat), last_slope);
    EXPECT_GT(barrier.curvature(t * dhat), 0);
    last_slope = barrier.slope(t * dhat);
  }
}

/// Near t = 1, b = dhat (1 - t)^3 + O((1 - t)^4): the second derivative vanishes there, the third does not.
TEST(ClampedLogBarrier, IsSmoothToSecondOrderAtItsActivationDistance) {
  for (const double s : {1e-3, 1e-5}) {
    const double d = dhat * (1 - s);
    EXPECT_NEAR(barrier.value(d), dhat * s * s * s, 2 * s * dhat * s * s * s);
    EXPECT_NEAR(barrier.slope(d), -3 * s * s, 6 * s * s * s);
    EXPECT_NEAR(barrier.curvature(d), 6 * s / dhat, 30 * s * s / dhat);
  }
}

TEST(ClampedLogBarrier, HasTheDerivativesOfItsDifferences) {
  for (const double t : {0.03, 0.3, 0.7, 0.97}) {
    const double d = t * dhat, h = 1e-6 * d;
    // Central differences: error of order h^2 b'''; slopes are exact to 1e-9 and curvatures likewise.
    EXPECT_NEAR((barrier.value(d + h) - barrier.value(d - h)) / (2 * h), barrier.slope(d),
                1e-8 * std::abs(barrier.slope(d)));
    EXPECT_NEAR((barrier.slope(d + h) - barrier.slope(d - h)) / (2 * h), barrier.curvature(d),
                1e-8 * barrier.curvature(d));
  }
}

/// A value of the barrier of the same name in ipctk 1.6.1, which acts on distances: at d = 0.4, dhat = 1.
TEST(ClampedLogBarrier, HasThePublishedValues) {
  constexpr ClampedLogBarrier unit{1};
  EXPECT_NEAR(unit.value(0.4), 0.36 * std::log(2.5), 1e-15);
  EXPECT_NEAR(unit.slope(0.4), 1.2 * std::log(0.4) - 0.9, 1e-15);
  EXPECT_NEAR(unit.curvature(0.4), 2 * std::log(2.5) + 6 + 2.25, 1e-14);
}

TEST(ClampedLogBarrier, KeepsTheDigitsOfSmallDifferences) {
  const double d = 0.3 * dhat, change = 1e-13 * dhat;
  // To first order; the second is 1e-13 of it.
  EXPECT_NEAR(barrier.difference(d, change), barrier.slope(d) * change,
              1e-12 * std::abs(barrier.slope(d) * change));
  for (const double end : {0.1, 0.5, 0.9, 1.1}) {
    EXPECT_NEAR(barrier.difference(d, end * dhat - d), barrier.value(end * dhat) - barrier.value(d),
                1e-14 * dhat);
    EXPECT_NEAR(barrier.difference(end * dhat, d - end * dhat), barrier.value(d) - barrier.value(end * dhat),
                1e-14 * dhat);
  }
}

}  // namespace
}  // namespace resilin
