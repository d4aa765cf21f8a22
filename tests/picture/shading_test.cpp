#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "resilin/core/parallel.hpp"
#include "resilin/picture/ground_shadow.hpp"
#include "resilin/picture/hidden_sky.hpp"

namespace resilin::testing {
namespace {

constexpr int width = 80, height = 60;

/// Depths of a picture whose pixels have them by a formula.
template <class Formula>
std::vector<float> depths_of(const Formula& formula) {
  std::vector<float> depths;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) depths.push_back(static_cast<float>(formula(x, y)));
  return depths;
}

float at(const std::vector<float>& values, int x, int y) {
  return values[static_cast<std::size_t>(y * width + x)];
}

TEST(HiddenSky, IsNoneOverPlanesHoweverTheyLean) {
  for (const double slope : {0.0, 0.3, -2.0, 5.0})
    for (const float hidden : hidden_sky(
             depths_of([&](int x, int y) { return 100 + slope * x - 0.5 * slope * y; }), width, height, 12))
      EXPECT_EQ(hidden, 0) << slope;
}

/// Before a wall: near its foot all directions of one half are blocked, far from it none, on it none.
TEST(HiddenSky, IsHalfAtTheFootOfAWallAndFadesAwayFromIt) {
  const std::vector<float> hidden =
      hidden_sky(depths_of([](int x, int) { return x < 40 ? 0 : 1000; }), width, height, 12);
  EXPECT_EQ(at(hidden, 10, 30), 0);
  EXPECT_EQ(at(hidden, 60, 30), 0);
  const std::vector<float> low =
      hidden_sky(depths_of([](int x, int) { return x < 40 ? 0 : 8; }), width, height, 12);
  double last = 0.5;
  for (const int x : {38, 35, 32, 29}) {
    EXPECT_GT(at(low, x, 30), 0) << x;
    EXPECT_LT(at(low, x, 30), last) << x;
    last = static_cast<double>(at(low, x, 30));
  }
  EXPECT_GT(at(low, 38, 30), 0.2);
}

TEST(HiddenSky, OfNothingIsNothingAndTheSameForAnyNumberOfThreads) {
  const auto pit = depths_of([](int x, int y) {
    const double r = std::hypot(x - 40, y - 30);
    return r > 25 ? -std::numeric_limits<double>::infinity() : -30 * std::exp(-r * r / 40);
  });
  const int threads = num_threads();
  set_num_threads(1);
  const std::vector<float> hidden = hidden_sky(pit, width, height, 15);
  set_num_threads(3);
  EXPECT_EQ(hidden, hidden_sky(pit, width, height, 15));
  set_num_threads(threads);
  EXPECT_EQ(at(hidden, 2, 2), 0);
  EXPECT_GT(at(hidden, 40, 30), 0.3);
  EXPECT_LT(at(hidden, 40, 10), 0.02);
}

/// A square of 1 m at a height.
std::vector<std::array<Vector3, 3>> plate(double z) {
  const Vector3 a(0, 0, z), b(1, 0, z), c(1, 1, z), d(0, 1, z);
  return {{a, b, c}, {a, c, d}};
}

TEST(GroundShadow, IsDarkUnderABodyThatLiesAndFainterTheHigherItIs) {
  const Vector3 up = Vector3::UnitZ();
  std::vector<std::array<Vector3, 3>> bodies = plate(0);
  const GroundShadow lying(bodies, up);
  EXPECT_NEAR(lying.at({0.5, 0.5, 0}), 1, 1e-12);
  EXPECT_NEAR(lying.at({0.5, 0.5, -1e-3}), 1, 0.01);
  EXPECT_EQ(lying.at({0.5, 0.5, 0.5}), 0) << "over it";
  EXPECT_EQ(lying.at({1.2, 0.5, 0}), 0) << "beside it";
  const double border = lying.at({1, 0.5, 0});
  EXPECT_GT(border, 0.3);
  EXPECT_LT(border, 0.7);
  double last = 1;
  for (const double z : {0.1, 0.3, 0.9}) {
    const double dark = GroundShadow(plate(z), up).at({0.5, 0.5, 0});
    EXPECT_LT(dark, last) << z;
    EXPECT_GT(dark, 0) << z;
    last = dark;
  }
}

TEST(GroundShadow, FallsAgainstTheGivenDirectionAndNeedsABody) {
  std::vector<std::array<Vector3, 3>> wall = {{Vector3(0, 0, 0), Vector3(0, 1, 0), Vector3(0, 0, 1)}};
  EXPECT_NEAR(GroundShadow(wall, Vector3::UnitX()).at({0, 0.3, 0.3}), 1, 1e-12);
  EXPECT_NEAR(GroundShadow(wall, -Vector3::UnitX()).at({1e-3, 0.3, 0.3}), 1, 0.01);
  EXPECT_EQ(GroundShadow({}, Vector3::UnitZ()).at({0, 0, 0}), 0);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  wall[0][0].x() = nan;
  EXPECT_EQ(GroundShadow(wall, Vector3::UnitZ()).at({nan, 0, 0}), 0);
}

}  // namespace
}  // namespace resilin::testing
