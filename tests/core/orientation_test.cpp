#include "resilin/core/orientation.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>

namespace resilin {
namespace {

__extension__ typedef __int128 Wide;
using Whole = std::array<std::int64_t, 3>;

int sign_of(Wide value) { return (value > 0 ? 1 : 0) - (value < 0 ? 1 : 0); }

/// The determinant of whole numbers, which is exact.
int whole_orientation(const std::array<Whole, 4>& p) {
  std::array<std::array<Wide, 3>, 3> m;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t k = 0; k < 3; ++k) m[i][k] = Wide{p[i + 1][k]} - p[0][k];
  Wide sum = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t i = (k + 1) % 3, j = (k + 2) % 3;
    sum += m[0][k] * (m[1][i] * m[2][j] - m[1][j] * m[2][i]);
  }
  return sign_of(sum);
}

/// Points nearly in one plane, as whole numbers: random ones, and a sum of the others with noise of one unit.
std::array<Whole, 4> nearly_flat(std::mt19937_64& generator, std::int64_t size) {
  std::uniform_int_distribution<std::int64_t> coordinate(-size, size), unit(-1, 1), share(-2, 2);
  std::array<Whole, 4> p;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::int64_t& x : p[i]) x = coordinate(generator);
  const std::int64_t a = share(generator), b = share(generator);
  for (std::size_t k = 0; k < 3; ++k)
    p[3][k] = p[0][k] + a * (p[1][k] - p[0][k]) + b * (p[2][k] - p[0][k]) + unit(generator);
  return p;
}

TEST(Orientation, IsExactForPointsNearlyInAPlane) {
  std::mt19937_64 generator(1);
  std::array<int, 3> seen{};
  for (int i = 0; i < 20000; ++i) {
    const auto whole = nearly_flat(generator, i % 2 == 0 ? 1000 : (std::int64_t{1} << 36));
    const double scale = std::ldexp(1, static_cast<int>(generator() % 200) - 100);
    std::array<Vector3, 4> p;
    for (std::size_t k = 0; k < 4; ++k)
      p[k] = scale * Vector3(static_cast<double>(whole[k][0]), static_cast<double>(whole[k][1]),
                             static_cast<double>(whole[k][2]));
    const int expected = whole_orientation(whole);
    ASSERT_EQ(orientation(p[0], p[1], p[2], p[3]), expected) << i;
    ASSERT_EQ(orientation(p[1], p[0], p[2], p[3]), -expected) << i;
    ++seen[static_cast<std::size_t>(expected + 1)];
  }
  for (const int count : seen) EXPECT_GT(count, 500);
}

TEST(Orientation, IsExactForPointsNearlyOnALine) {
  std::mt19937_64 generator(2);
  std::uniform_int_distribution<std::int64_t> coordinate(-(std::int64_t{1} << 48), std::int64_t{1} << 48),
      unit(-1, 1);
  for (int i = 0; i < 20000; ++i) {
    const std::array<std::int64_t, 2> a = {coordinate(generator), coordinate(generator)},
                                      d = {coordinate(generator) / 16, coordinate(generator) / 16};
    const std::array<std::int64_t, 2> b = {a[0] + d[0], a[1] + d[1]}, c = {a[0] + 3 * d[0] + unit(generator),
                                                                           a[1] + 3 * d[1] + unit(generator)};
    const Wide determinant = Wide{b[0] - a[0]} * (c[1] - a[1]) - Wide{b[1] - a[1]} * (c[0] - a[0]);
    const auto point = [](const std::array<std::int64_t, 2>& p) {
      return Eigen::Vector2d(static_cast<double>(p[0]), static_cast<double>(p[1]));
    };
    ASSERT_EQ(orientation(point(a), point(b), point(c)), sign_of(determinant)) << i;
  }
}

}  // namespace
}  // namespace resilin
