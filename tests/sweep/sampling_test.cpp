#include "resilin/sweep/sampling.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <set>
#include <vector>

namespace resilin::testing {
namespace {

TEST(Sampling, PermutationsReachEveryNumberOnce) {
  for (const std::uint64_t count : {1, 2, 3, 7, 64, 65, 1000}) {
    std::set<std::uint64_t> reached;
    for (std::uint64_t i = 0; i < count; ++i) reached.insert(permuted(i, count, 7));
    EXPECT_EQ(reached.size(), count);
    EXPECT_EQ(*reached.rbegin(), count - 1);
  }
}

TEST(Sampling, PermutationsOfAnotherKeyAreOthers) {
  int same = 0;
  for (std::uint64_t i = 0; i < 1000; ++i) same += permuted(i, 1000, 1) == permuted(i, 1000, 2) ? 1 : 0;
  EXPECT_LT(same, 15);  // one is expected of independent ones
}

TEST(Sampling, LatinHypercubesHaveOnePointInEachSliceOfEachCoordinate) {
  constexpr std::uint64_t count = 257;
  for (std::size_t dimension = 0; dimension < 5; ++dimension) {
    std::set<std::uint64_t> slices;
    for (std::uint64_t i = 0; i < count; ++i) {
      const double x = latin_hypercube(i, dimension, count, 3);
      ASSERT_GE(x, 0);
      ASSERT_LT(x, 1);
      slices.insert(static_cast<std::uint64_t>(x * count));
    }
    EXPECT_EQ(slices.size(), count);
  }
}

/// Correlation of two coordinates: within a few of the 1/sqrt(count) that chance gives.
TEST(Sampling, CoordinatesOfALatinHypercubeAreIndependent) {
  constexpr std::uint64_t count = 4096;
  double sum = 0;
  for (std::uint64_t i = 0; i < count; ++i)
    sum += (latin_hypercube(i, 0, count, 5) - 0.5) * (latin_hypercube(i, 1, count, 5) - 0.5) * 12;
  EXPECT_LT(std::abs(sum / count), 4 / std::sqrt(double{count}));
}

/// Points 7 and 13 as scipy 1.10 has them (stats.qmc.Sobol, not scrambled), which takes the same numbers of
/// Joe and Kuo.
TEST(Sampling, SobolPointsAreThoseOfAnotherProgram) {
  constexpr std::array<double, 32> seventh = {0.125, 0.625, 0.375, 0.125, 0.125, 0.375, 0.625, 0.625,
                                              0.625, 0.875, 0.625, 0.125, 0.625, 0.375, 0.125, 0.125,
                                              0.125, 0.125, 0.625, 0.875, 0.875, 0.375, 0.625, 0.125,
                                              0.125, 0.625, 0.625, 0.875, 0.875, 0.375, 0.625, 0.875};
  constexpr std::array<double, 32> thirteenth = {
      0.8125, 0.6875, 0.8125, 0.0625, 0.4375, 0.9375, 0.5625, 0.5625, 0.5625, 0.4375, 0.8125,
      0.9375, 0.0625, 0.8125, 0.1875, 0.5625, 0.1875, 0.6875, 0.5625, 0.9375, 0.5625, 0.0625,
      0.8125, 0.5625, 0.0625, 0.4375, 0.4375, 0.0625, 0.0625, 0.3125, 0.5625, 0.4375};
  for (std::size_t d = 0; d < most_sobol_dimensions; ++d) {
    EXPECT_EQ(sobol(0, d), 0);
    EXPECT_EQ(sobol(7, d), seventh[d]) << d;
    EXPECT_EQ(sobol(13, d), thirteenth[d]) << d;
  }
}

/// Each coordinate of 2^m points has one point in each of 2^m slices; the first two together one in each of
/// 2^a x 2^(m - a) boxes (a net with t = 0). A shift by digits keeps both.
TEST(Sampling, SobolPointsFillTheCubeEvenlyShiftedOrNot) {
  constexpr int m = 10;
  constexpr std::uint64_t count = 1 << m;
  for (const bool is_shifted : {false, true}) {
    const auto point = [is_shifted](std::uint64_t i, std::size_t d) {
      return is_shifted ? shifted_sobol(i, d, 11) : sobol(i, d);
    };
    for (std::size_t d = 0; d < most_sobol_dimensions; ++d) {
      std::set<std::uint64_t> slices;
      for (std::uint64_t i = 0; i < count; ++i)
        slices.insert(static_cast<std::uint64_t>(point(i, d) * count));
      EXPECT_EQ(slices.size(), count) << d;
    }
    for (int a = 0; a <= m; ++a) {
      std::set<std::pair<std::uint64_t, std::uint64_t>> boxes;
      for (std::uint64_t i = 0; i < count; ++i)
        boxes.emplace(static_cast<std::uint64_t>(point(i, 0) * (1 << a)),
                      static_cast<std::uint64_t>(point(i, 1) * (1 << (m - a))));
      EXPECT_EQ(boxes.size(), count) << a;
    }
  }
}

TEST(Sampling, ShiftedPointsDependOnTheSeedAndStayInside) {
  EXPECT_NE(shifted_sobol(0, 0, 1), shifted_sobol(0, 0, 2));
  for (std::uint64_t i = 0; i < 1000; ++i) {
    EXPECT_GE(shifted_sobol(i, 3, 1), 0);
    EXPECT_LT(shifted_sobol(i, 3, 1), 1);
  }
}

}  // namespace
}  // namespace resilin::testing
