#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <map>

#include "pictured_bar.hpp"

// Backgrounds, colours of bodies, shadows and the ends of the bar.

namespace resilin::testing {
namespace {

/// Put on white, what is seen through is the picture on white: bodies, edges, letters and veils alike.
TEST(Picture, WithoutABackgroundIsTheSameOnWhite) {
  for (const char* field : {"x", no_field}) {
    PictureOptions options = small(field);
    options.edges = "on";
    const Image opaque = draw_picture(bar(), options, walls());
    EXPECT_TRUE(opaque.opacity.empty());
    options.is_transparent = true;
    const Image clear = draw_picture(bar(), options, walls());
    ASSERT_EQ(clear.opacity.size(), clear.pixels.size());
    EXPECT_EQ(channels(clear).size(), 4 * clear.pixels.size());
    EXPECT_LT(clear.opacity.front(), 255);
    EXPECT_EQ(std::ranges::max(clear.opacity), 255);
    int worst = 0;
    for (std::size_t i = 0; i < clear.pixels.size(); ++i) {
      const Color seen = mix(white, clear.pixels[i], clear.opacity[i] / 255.0), meant = opaque.pixels[i];
      worst = std::max({worst, std::abs(seen.red - meant.red), std::abs(seen.green - meant.green),
                        std::abs(seen.blue - meant.blue)});
    }
    EXPECT_LE(worst, 3) << field;
  }
}

TEST(Picture, WithoutAFieldGivesEachBodyItsColour) {
  VtuContent frame = bar();
  PictureOptions options = small(no_field);
  const auto colours = [&] {
    const Image image = draw_picture(frame, options);
    EXPECT_EQ(image.legend, "");
    std::map<std::array<std::uint8_t, 3>, int> counts;
    for (const Color& c : image.pixels) ++counts[{c.red, c.green, c.blue}];
    return std::ranges::count_if(counts, [](const auto& tone) { return tone.second > 1000; });
  };
  EXPECT_EQ(colours(), 2) << "one and the background";
  VtuValues bodies{"body", 1, {}};
  for (const double number : frame.cell_data[0].values) bodies.values.push_back(number < 24 ? 0 : 1);
  frame.cell_data.push_back(bodies);
  EXPECT_EQ(colours(), 3);
}

/// The end beyond which there are values is pointed.
TEST(Picture, PointsTheBarWhereValuesLieBeyondIt) {
  PictureOptions options = small("x");
  const auto pixels_with = [&](std::array<double, 2> range) {
    options.range = range;
    const Image image = draw_picture(bar(), options);
    const auto above = [&](double from, double to) {
      int count = 0;
      for (int y = static_cast<int>(from * image.height); y < static_cast<int>(to * image.height); ++y)
        for (int x = image.width * 3 / 4; x < image.width; ++x) {
          const Color c = image.at(x, y);
          count += std::max({c.red, c.green, c.blue}) - std::min({c.red, c.green, c.blue}) > 60 ? 1 : 0;
        }
      return count;
    };
    return std::array{above(0, 0.165), above(0.84, 1)};
  };
  EXPECT_EQ(pixels_with({0, 2}), (std::array{0, 0}));
  const auto [over, none_below] = pixels_with({0, 1});
  EXPECT_GT(over, 10);
  EXPECT_EQ(none_below, 0);
  const auto [none_over, under] = pixels_with({1, 2});
  EXPECT_EQ(none_over, 0);
  EXPECT_GT(under, 10);
}

/// The floor just before a body that lies on it is darker than the floor aside.
TEST(Picture, HasTheShadowOfABodyOnWhatLiesBelowIt) {
  PictureOptions options = small(no_field);
  options.view = "0.3,-1,0.6";
  Mesh floor;
  floor.vertices = {{-9, -9, 0}, {9, -9, 0}, {9, 9, 0}, {-9, 9, 0}};
  floor.block(CellKind::triangle).nodes = {0, 1, 2, 0, 2, 3};
  VtuContent frame = bar();
  frame.cell_data.push_back({"body", 1, std::vector<double>(frame.cell_data[0].values.size(), 0.0)});
  const Image image = draw_picture(frame, options, floor);
  const auto is_body = [](Color c) { return c.red - c.blue > 30; };
  const int middle = image.width / 2;
  int foot = image.height - 1;
  while (foot > 0 && !is_body(image.at(middle, foot))) --foot;
  ASSERT_GT(foot, image.height / 2);
  ASSERT_LT(foot, image.height - 10);
  int darkest = 255, aside = 255;
  for (int row = foot + 1; row < foot + 9; ++row) {
    darkest = std::min<int>(darkest, image.at(middle, row).green);
    aside = std::min<int>(aside, image.at(image.width - 3, row).green);
  }
  EXPECT_LT(darkest + 25, aside) << "foot at " << foot;
}

}  // namespace
}  // namespace resilin::testing
