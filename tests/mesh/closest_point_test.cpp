#include "resilin/mesh/closest_point.hpp"

#include <gtest/gtest.h>

#include <random>

namespace resilin::testing {
namespace {

/// Against a fine grid of points of the triangle, for points above it and all around.
TEST(ClosestPoint, OfATriangleIsNoFartherThanAnyOtherOfItsPoints) {
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  const auto point = [&] { return Vector3(normal(random), normal(random), normal(random)); };
  for (int sample = 0; sample < 200; ++sample) {
    const Vector3 p = point(), a = point(), b = point();
    const Vector3 c = sample % 10 == 0 ? Vector3(0.3 * a + 0.7 * b) : point();  // some without area
    const auto share = closest_on_triangle(p, a, b, c);
    EXPECT_NEAR(share[0] + share[1] + share[2], 1, 1e-14);
    EXPECT_GE(std::min({share[0], share[1], share[2]}), 0);
    const double found = (share[0] * a + share[1] * b + share[2] * c - p).norm();
    constexpr int n = 20;
    for (int i = 0; i <= n; ++i)
      for (int j = 0; i + j <= n; ++j) {
        const Vector3 other = (i * a + j * b + (n - i - j) * c) / n;
        EXPECT_LE(found, (other - p).norm() * (1 + 1e-14));
      }
  }
}

TEST(ClosestPoint, OfASegmentWithoutLengthIsItsEnd) {
  const auto share = closest_on_segment({1, 2, 3}, {1, 1, 1}, {1, 1, 1});
  EXPECT_EQ(share[0] + share[1], 1);
}

}  // namespace
}  // namespace resilin::testing
