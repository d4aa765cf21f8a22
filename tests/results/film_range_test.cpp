#include <gtest/gtest.h>

#include <cmath>

#include "resilin/results/result_film.hpp"

namespace resilin::testing {
namespace {

using Range = std::array<double, 2>;

TEST(FilmRange, IsThatOfAllFramesWhereTheyAreAlike) {
  std::vector<Range> growing;
  for (int i = 0; i <= 40; ++i) growing.push_back({0, i * 10.0});
  EXPECT_EQ(film_range(growing), (Range{0, 400}));
  EXPECT_EQ(film_range({{3, 7}}), (Range{3, 7}));
  EXPECT_EQ(film_range({{-2, -1}, {-5, -3}}), (Range{-5, -1}));
}

TEST(FilmRange, LeavesOutSingleBlowsOnBothSides) {
  std::vector<Range> frames(50, Range{-1, 20});
  frames[7] = {-90, 800};
  frames[8] = {-3, 300};
  EXPECT_EQ(film_range(frames), (Range{-1, 20}));
  // A load for a fifth of the time is no blow.
  for (std::size_t i = 20; i < 30; ++i) frames[i] = {-40, 500};
  EXPECT_EQ(film_range(frames)[1], 800) << "less than twice 500";
}

TEST(FilmRange, KeepsWhatMovesOutOfNothing) {
  std::vector<Range> frames(50, Range{0, 0});
  frames[49] = {-1, 5};
  EXPECT_EQ(film_range(frames), (Range{-1, 5}));
}

}  // namespace
}  // namespace resilin::testing
