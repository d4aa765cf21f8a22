#include <gtest/gtest.h>

#include <cmath>

#include "resilin/picture/color_map.hpp"
#include "resilin/picture/color_scale.hpp"

namespace resilin::testing {
namespace {

double lightness(Color color) { return 0.2126 * color.red + 0.7152 * color.green + 0.0722 * color.blue; }

TEST(ColorMap, GrowsLighterFromLessToMore) {
  for (int i = 0; i < 100; ++i)
    EXPECT_LT(lightness(map_color("viridis", i / 100.0)), lightness(map_color("viridis", (i + 1) / 100.0)));
  EXPECT_EQ(map_color("viridis", -3), map_color("viridis", 0));
  EXPECT_EQ(map_color("viridis", 7), map_color("viridis", 1));
}

TEST(ColorMap, OfTwoSignsIsBlueAndRedAndEquallyDark) {
  const Color low = map_color("diverging", 0), middle = map_color("diverging", 0.5),
              high = map_color("diverging", 1);
  EXPECT_GT(low.blue, 1.5 * low.red);
  EXPECT_GT(high.red, 1.5 * high.blue);
  EXPECT_NEAR(middle.red, middle.blue, 2);
  EXPECT_GT(lightness(middle), 2 * lightness(low));
  EXPECT_NEAR(lightness(low), lightness(high), 25);
}

TEST(ColorScale, TakesTheRangeOfTheValuesThatAreNumbers) {
  const ColorScale scale = choose_scale(std::vector<double>{3, NAN, 1, INFINITY, 2}, {}, "auto");
  EXPECT_EQ(scale.low, 1);
  EXPECT_EQ(scale.high, 3);
  EXPECT_EQ(scale.map, "viridis");
}

TEST(ColorScale, IsSymmetricForTwoSigns) {
  const ColorScale scale = choose_scale(std::vector<double>{-1, 3}, {}, "auto");
  EXPECT_EQ(scale.map, "diverging");
  EXPECT_EQ(scale.low, -3);
  EXPECT_EQ(scale.high, 3);
  EXPECT_EQ(scale.least, -1);
}

TEST(ColorScale, PutsAFieldThatIsTheSameEverywhereInTheMiddle) {
  const ColorScale scale = choose_scale(std::vector<double>{5, 5 + 1e-13}, {}, "auto");
  EXPECT_NEAR(scale.place(5), 0.5, 1e-6);
  EXPECT_NEAR(choose_scale(std::vector<double>{0, 0}, {}, "auto").place(0), 0.5, 1e-12);
}

TEST(ScaleText, CountsInThousandsOfTheUnit) {
  const ColorScale scale = choose_scale(std::vector<double>{0, 110e3}, {}, "auto");
  const ScaleText text = scale_text(scale, "stress", "Pa");
  EXPECT_EQ(text.title, "stress [kPa]");
  ASSERT_EQ(text.ticks.size(), 6u);
  EXPECT_EQ(text.ticks[1].text, "20");
  EXPECT_NEAR(text.ticks[1].place, 20.0 / 110, 1e-12);
  EXPECT_EQ(text.extremes, "min 0.0   max 110.0");
}

TEST(ScaleText, WritesSmallAndSignedNumbers) {
  const ScaleText strain =
      scale_text(choose_scale(std::vector<double>{-2e-5, 4e-5}, {}, "auto"), "strain", "");
  EXPECT_EQ(strain.title, "strain [10\u207B\u2076]");
  EXPECT_EQ(strain.ticks.front().text, "\u221240");
  const ScaleText ratio = scale_text(choose_scale(std::vector<double>{0.98, 1.01}, {}, "auto"), "ratio", "");
  EXPECT_EQ(ratio.title, "ratio");
  EXPECT_EQ(ratio.ticks.front().text, "0.980");
  const ScaleText energy =
      scale_text(choose_scale(std::vector<double>{0, 5e6}, {}, "auto"), "energy", "J/m^3");
  EXPECT_EQ(energy.title, "energy [MJ/m\u00B3]");
}

}  // namespace
}  // namespace resilin::testing
