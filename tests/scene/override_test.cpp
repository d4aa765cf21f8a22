#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "scene_text.hpp"

namespace resilin::testing {
namespace {

using ::testing::HasSubstr;

TEST(Override, ReachesKeysByNameAndByNumber) {
  const Description d =
      read_good_scene_with({"simulation.gravity=[0,0,-1]", "body.0.material.youngs_modulus=1e5",
                            "body.beam.scale=2", "fix.wall.displacement=[0, 0, 1]"})
          .description;
  EXPECT_EQ(d.gravity, Vector3(0, 0, -1));
  EXPECT_EQ(d.bodies[0].material.constants.at("youngs_modulus"), 1e5);
  EXPECT_EQ(d.bodies[0].scale, 2);
  EXPECT_EQ(d.fixes[0].displacement, Vector3(0, 0, 1));
}

TEST(Override, MakesTablesThatTheSceneDoesNotHave) {
  EXPECT_EQ(read_good_scene_with({"newton.max_iterations=7"}).description.newton.max_iterations, 7);
}

TEST(Override, TakesABareWordAsText) {
  EXPECT_EQ(read_good_scene_with({"body.0.material.law=linear_elastic"}).description.bodies[0].material.law,
            "linear_elastic");
  EXPECT_EQ(read_good_scene_with({"title=A longer title, by hand"}).description.title,
            "A longer title, by hand");
  EXPECT_EQ(read_good_scene_with({"title=\"quoted\""}).description.title, "quoted");
}

TEST(Override, AppliesInTheirOrder) {
  EXPECT_EQ(read_good_scene_with({"body.0.scale=2", "body.0.scale=3"}).description.bodies[0].scale, 3);
}

TEST(Override, IsThePlaceOfTheErrorThatItCauses) {
  EXPECT_EQ(error_with({"body.0.scale=-2"}),
            "--set body.0.scale=-2: body[0].scale: expected a number > 0, got -2");
}

TEST(Override, TakesAPartInQuotesWithItsDots) {
  SceneValue scene = parse_toml("[[body]]\nname = \"a.b\"\n", "scene.toml");
  apply_override(scene, "body.\"a.b\".scale=2");
  EXPECT_EQ(std::get<std::int64_t>(scene.find("body")->array()[0].find("scale")->data), 2);
  EXPECT_EQ(numbered_key(scene, "body.\"a.b\".scale", "here"), "body.0.scale");
}

TEST(Override, NamesTheNearestEntry) {
  EXPECT_THAT(error_with({"body.bean.scale=2"}),
              HasSubstr("got \"bean\"; did you mean \"beam\"? the one entry is \"beam\" (0)"));
}

TEST(Override, RefusesAPathThatLeadsNowhere) {
  EXPECT_THAT(error_with({"body.1.scale=2"}), HasSubstr("got \"1\"; the one entry is \"beam\" (0)"));
  EXPECT_THAT(error_with({"title.x=2"}), HasSubstr("expected a table before \"x\""));
  EXPECT_THAT(error_with({"simulatoin.gravity=[0,0,0]"}), HasSubstr("did you mean \"simulation\"?"));
}

TEST(Override, RefusesWhatIsNoAssignmentOrNoValue) {
  for (const std::string assignment : {"", "=", "a", "a.=1", ".a=1", "a..b=1"}) {
    EXPECT_THAT(error_with({assignment}), HasSubstr("KEY=VALUE")) << assignment;
  }
  for (const std::string value : {"[1,", "{", "1 2", "", "\"open", "1\nb = 2", "2020-01-01"}) {
    EXPECT_THAT(error_with({"simulation.end_time=" + value}), HasSubstr("--set simulation.end_time="))
        << value;
  }
}

}  // namespace
}  // namespace resilin::testing
